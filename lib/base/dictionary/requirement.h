// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/fields.h"

namespace landfall {

/// A requirement on a number of a result: one of the dictionary, or one that the user sets.
struct Requirement {
  std::string name;
  std::string metric;  ///< dotted path of the number: "statistics.z.le90_m"; "A + B" for a sum
  double limit = 0;
  bool at_least = false;  ///< true: the limit is the smallest value that passes; false: the largest
  friend bool operator==(const Requirement&, const Requirement&) = default;
};

/// A value equal to its limit passes.
struct RequirementVerdict {
  Requirement requirement;
  bool is_own = true;  ///< set by the user, so that the metric and the direction are written too
  std::optional<double> value = std::nullopt;
  std::optional<bool> pass = std::nullopt;           ///< null: not judged
  std::optional<std::string> reason = std::nullopt;  ///< why it is not judged, in a word
  static void fields(auto& walk, auto& m) {
    if (m.is_own) walk("metric", m.requirement.metric);
    walk("value", m.value);
    walk("limit", m.requirement.limit);
    if (m.is_own) walk("at_least", m.requirement.at_least);
    walk("pass", m.pass);
  }
  friend bool operator==(const RequirementVerdict&, const RequirementVerdict&) = default;
};

/// Verdicts in the order of the dictionary or of the configuration; the fields of each are under its name.
struct RequirementVerdicts {
  std::vector<RequirementVerdict> all;
  static void fields(auto& walk, auto& m) {
    for (auto& verdict : m.all) walk(verdict.requirement.name, verdict);
  }
  /// Throws std::out_of_range for a name that is not there.
  [[nodiscard]] RequirementVerdict& operator[](std::string_view name) {
    for (RequirementVerdict& verdict : all)
      if (verdict.requirement.name == name) return verdict;
    throw std::out_of_range(std::string(name));
  }
  [[nodiscard]] const RequirementVerdict& operator[](std::string_view name) const {
    return const_cast<RequirementVerdicts&>(
        *this)[name];  // NOLINT(*-const-cast): the other one, which only reads
  }
  friend bool operator==(const RequirementVerdicts&, const RequirementVerdicts&) = default;
};

/// Whether any of them has this verdict.
[[nodiscard]] inline bool any_is(const RequirementVerdicts& verdicts, std::optional<bool> pass) {
  return std::ranges::any_of(verdicts.all,
                             [&](const RequirementVerdict& verdict) { return verdict.pass == pass; });
}

/// For the user's own requirements, each of which is judged.
[[nodiscard]] inline bool all_pass(const RequirementVerdicts& verdicts) { return !any_is(verdicts, false); }

/// The path of a field of a result, and whether a requirement can be set on it.
struct ResultField {
  std::string path;
  bool is_number = false;
};

namespace requirement {

template <class T>
inline constexpr bool kIsNumber = (std::integral<T> && !std::same_as<T, bool>) || std::floating_point<T>;
template <class T>
inline constexpr bool kIsNumber<std::optional<T>> = kIsNumber<T>;

template <class T>
requires kIsNumber<T> std::optional<double> number_of(const T& value) { return static_cast<double>(value); }
template <class T>
requires kIsNumber<T> std::optional<double> number_of(const std::optional<T>& value) {
  return value ? number_of(*value) : std::nullopt;
}
std::optional<double> number_of(const auto& /*no number*/) { return std::nullopt; }

/// A visit that makes every optional struct.
struct Filling {
  static bool has(const std::string& /*path*/) { return true; }
  void operator()(const std::string& /*path*/, auto& /*value*/) const {}
};

}  // namespace requirement

/// A T with every optional struct.
template <class T>
[[nodiscard]] T complete() {
  T result;
  FieldWalk walk{requirement::Filling()};
  T::fields(walk, result);
  return result;
}

/// The fields of a struct (base/core/fields.h) in their order.
template <class T>
[[nodiscard]] std::vector<ResultField> result_fields(const T& result) {
  std::vector<ResultField> fields;
  FieldWalk walk{[&](const std::string& path, const auto& value) {
    fields.push_back({path, requirement::kIsNumber<std::remove_cvref_t<decltype(value)>>});
  }};
  T::fields(walk, result);
  return fields;
}

/// The number at a dotted path of a struct, or the sum of several: "A + B"; none if one is null or does not
/// exist.
template <class T>
[[nodiscard]] std::optional<double> number_at(const T& result, std::string_view path) {
  if (const std::size_t plus = path.find(" + "); plus != std::string_view::npos) {
    const auto first = number_at(result, path.substr(0, plus));
    const auto rest = number_at(result, path.substr(plus + 3));
    return first && rest ? std::optional(*first + *rest) : std::nullopt;
  }
  std::optional<double> found;
  FieldWalk walk{[&](const std::string& at, const auto& value) {
    if (at == path) found = requirement::number_of(value);
  }};
  T::fields(walk, result);
  return found;
}

/// NaN does not pass.
[[nodiscard]] inline bool passes(const Requirement& requirement, double value) {
  return requirement.at_least ? value >= requirement.limit : value <= requirement.limit;
}

/// Judges the user's requirements on the numbers of a result; one that is null or not finite, or that of no
/// result, does not pass.
template <class T>
[[nodiscard]] RequirementVerdicts judge_own(const T* result, const std::vector<Requirement>& requirements) {
  RequirementVerdicts verdicts;
  for (const Requirement& requirement : requirements) {
    auto value = result != nullptr ? number_at(*result, requirement.metric) : std::nullopt;
    if (value && !std::isfinite(*value)) value.reset();
    verdicts.all.push_back({requirement, true, value, value && passes(requirement, *value)});
  }
  return verdicts;
}

}  // namespace landfall
