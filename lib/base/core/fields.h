// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

/// Lists the members of a struct for a FieldWalk, and defines == as equality of these members. Only
/// templates: most units that include a struct never walk it.
#define LANDFALL_FIELDS(...)                                                  \
  using ListsFields = void;                                                   \
  auto with_fields(const auto& take) { return take(__VA_ARGS__); }            \
  auto with_fields(const auto& take) const { return take(__VA_ARGS__); }      \
  static void fields(auto& walk, auto& m) {                                   \
    m.with_fields([&](auto&... field) { walk.all(#__VA_ARGS__, field...); }); \
  }

namespace landfall {

template <class T>
requires requires { typename T::ListsFields; }
bool operator==(const T& a, const T& b) {
  return a.with_fields(
      [&](const auto&... x) { return b.with_fields([&](const auto&... y) { return (... && (x == y)); }); });
}

/// Visits the values of nested structs by their dotted paths ("accuracy.absolute.x.p95_m"), so that a file's
/// writer, its reader and a table of results share one list of names.
///
/// A field is a value, a struct with LANDFALL_FIELDS or with its own `fields`, or an optional struct. The
/// walk calls visit(path, value); values are const where the struct is. An empty optional struct is skipped;
/// if the struct defines `kShownEmpty`, each of its values is visited as std::nullopt. A walk over structs
/// that are not const fills an optional struct where visit.has(path) is true.
template <class Visit>
class FieldWalk {
 public:
  explicit FieldWalk(Visit visit) : visit_(std::move(visit)) {}

  template <class T>
  void operator()(std::string_view name, T& field) {
    inside(name, [&] { walk(field); });
  }

  /// `names` are separated by ", ".
  void all(std::string_view names, auto&... field) {
    const auto next_name = [&] {
      const std::string_view name = names.substr(0, names.find(','));
      names.remove_prefix(std::min(names.size(), name.size() + 2));
      return name;
    };
    ((*this)(next_name(), field), ...);
  }

  /// Prefixes the paths that `work` visits with `name`.
  template <class Work>
  void inside(std::string_view name, const Work& work) {
    const std::size_t length = path_.size();
    path_.append(length > 0 ? "." : "").append(name);
    work();
    path_.resize(length);
  }

 private:
  template <class T>
  static constexpr bool kHasFields = requires(FieldWalk& walk, T& m) {
    T::fields(walk, m);
  };

  template <class T>
  void walk(T& value) {
    if constexpr (std::is_const_v<T>)
      if (is_empty_) return visit_(std::as_const(path_), std::nullopt);
    visit_(std::as_const(path_), value);
  }

  template <class T>
  requires kHasFields<std::remove_const_t<T>>
  void walk(T& field) { std::remove_const_t<T>::fields(*this, field); }

  template <class T>
  requires kHasFields<T>
  void walk(const std::optional<T>& field) {
    if (field) return walk(*field);
    if constexpr (requires { T::kShownEmpty; }) {
      const T none{};
      const bool outer = std::exchange(is_empty_, true);
      walk(none);
      is_empty_ = outer;
    }
  }

  template <class T>
  requires kHasFields<T>
  void walk(std::optional<T>& field) {
    if (visit_.has(std::as_const(path_))) walk(field.emplace(T{}));
  }

  Visit visit_;
  std::string path_;
  bool is_empty_ = false;  ///< inside an empty optional struct
};

}  // namespace landfall
