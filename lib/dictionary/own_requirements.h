// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/fields.h"

namespace landfall {

/// A requirement that the user sets on one number of a result, beside those of the dictionary.
struct OwnRequirement {
  std::string name;
  std::string metric;  ///< dotted path of the number: "statistics.z.le90_m"
  double limit = 0;
  bool at_least = false;  ///< true: the limit is the smallest value that passes; false: the largest
  friend bool operator==(const OwnRequirement&, const OwnRequirement&) = default;
};

/// A value equal to its limit passes; a number that is not known does not.
struct OwnVerdict {
  OwnRequirement requirement;
  std::optional<double> value = std::nullopt;
  bool pass = false;
  static void fields(auto& walk, auto& m) {
    walk("metric", m.requirement.metric);
    walk("value", m.value);
    walk("limit", m.requirement.limit);
    walk("at_least", m.requirement.at_least);
    walk("pass", m.pass);
  }
  friend bool operator==(const OwnVerdict&, const OwnVerdict&) = default;
};

/// Verdicts in the order of the configuration; the fields of each are under its name.
struct OwnVerdicts {
  std::vector<OwnVerdict> all;
  static void fields(auto& walk, auto& m) {
    for (auto& verdict : m.all) walk(verdict.requirement.name, verdict);
  }
  friend bool operator==(const OwnVerdicts&, const OwnVerdicts&) = default;
};

[[nodiscard]] inline bool all_pass(const OwnVerdicts& verdicts) {
  for (const OwnVerdict& verdict : verdicts.all)
    if (!verdict.pass) return false;
  return true;
}

/// The path of a field of a result, and whether a requirement can be set on it.
struct ResultField {
  std::string path;
  bool is_number = false;
};

namespace own_requirement {

template <class T>
inline constexpr bool kIsNumber = (std::integral<T> && !std::same_as<T, bool>) || std::floating_point<T>;
template <class T>
inline constexpr bool kIsNumber<std::optional<T>> = kIsNumber<T>;

template <class T>
requires kIsNumber<T> std::optional<double> number_of(const T& value) {
  const auto number = static_cast<double>(value);
  return std::isfinite(number) ? std::optional(number) : std::nullopt;
}
template <class T>
requires kIsNumber<T> std::optional<double> number_of(const std::optional<T>& value) {
  return value ? number_of(*value) : std::nullopt;
}
std::optional<double> number_of(const auto& /*no number*/) { return std::nullopt; }

}  // namespace own_requirement

/// The fields of a struct (base/fields.h) in their order.
template <class T>
[[nodiscard]] std::vector<ResultField> result_fields(const T& result) {
  std::vector<ResultField> fields;
  FieldWalk walk{[&](const std::string& path, const auto& value) {
    fields.push_back({path, own_requirement::kIsNumber<std::remove_cvref_t<decltype(value)>>});
  }};
  T::fields(walk, result);
  return fields;
}

/// The number at a dotted path of a struct; none if it is null, is not finite, or does not exist.
template <class T>
[[nodiscard]] std::optional<double> number_at(const T& result, std::string_view path) {
  std::optional<double> found;
  FieldWalk walk{[&](const std::string& at, const auto& value) {
    if (at == path) found = own_requirement::number_of(value);
  }};
  T::fields(walk, result);
  return found;
}

[[nodiscard]] inline OwnVerdict judge_own(const OwnRequirement& requirement, std::optional<double> value) {
  const double limit = requirement.limit;
  return {requirement, value, value && (requirement.at_least ? *value >= limit : *value <= limit)};
}

/// Judges the numbers of a result; without one, none is known.
template <class T>
[[nodiscard]] OwnVerdicts judge_own(const T* result, const std::vector<OwnRequirement>& requirements) {
  OwnVerdicts verdicts;
  for (const OwnRequirement& requirement : requirements)
    verdicts.all.push_back(
        judge_own(requirement, result != nullptr ? number_at(*result, requirement.metric) : std::nullopt));
  return verdicts;
}

}  // namespace landfall
