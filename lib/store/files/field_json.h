// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/core/fields.h"

namespace landfall {

/// The value, or null where it is not finite.
[[nodiscard]] inline nlohmann::ordered_json finite_json(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

/// Writes the fields that a walk visits into nested JSON objects. A number that is not finite becomes null.
class FieldWriter {
 public:
  using Json = nlohmann::ordered_json;
  explicit FieldWriter(Json& json) : json_(json) {}

  void operator()(const std::string& path, const auto& value) const { json_[pointer(path)] = json_of(value); }

  [[nodiscard]] static Json::json_pointer pointer(std::string path) {
    std::ranges::replace(path, '.', '/');
    return Json::json_pointer("/" + path);
  }

 private:
  static Json json_of(std::nullopt_t /*none*/) { return nullptr; }
  static Json json_of(double value) { return finite_json(value); }
  template <class T>
  static Json json_of(const std::optional<T>& value) {
    return value ? json_of(*value) : Json(nullptr);
  }
  template <class T>
  static Json json_of(const T& value) {
    return value;
  }

  Json& json_;
};

/// Reads what FieldWriter wrote; null for a number becomes infinity. Throws nlohmann::json::exception if a
/// field is missing or has another type.
class FieldReader {
 public:
  using Json = nlohmann::ordered_json;
  explicit FieldReader(const Json& json) : json_(json) {}

  /// Whether an optional struct has any value.
  [[nodiscard]] bool has(const std::string& path) const {
    const Json::json_pointer pointer = FieldWriter::pointer(path);
    if (!json_.contains(pointer)) return false;
    const Json values = json_.at(pointer).flatten();
    return std::ranges::any_of(values, [](const Json& value) { return !value.is_null(); });
  }

  void operator()(const std::string& path, auto& value) const {
    read(json_.at(FieldWriter::pointer(path)), value);
  }

 private:
  static void read(const Json& json, double& value) {
    value = json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
  }
  static void read(const Json& json, std::int64_t& value) {
    value = json.get_ref<const Json::number_integer_t&>();
  }
  template <class T>
  static void read(const Json& json, std::optional<T>& value) {
    if (!json.is_null()) read(json, value.emplace());
  }
  template <class T>
  static void read(const Json& json, std::vector<T>& values) {
    for (const Json& element : json.get_ref<const Json::array_t&>()) read(element, values.emplace_back());
  }
  template <class T>
  static void read(const Json& json, T& value) {
    json.get_to(value);
  }

  const Json& json_;
};

/// The value, or null where there is none.
template <class T>
[[nodiscard]] nlohmann::ordered_json or_null(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

/// Converts the fields of a struct (base/core/fields.h) to nested objects, and back.
template <class T>
[[nodiscard]] nlohmann::ordered_json fields_json(const T& value) {
  nlohmann::ordered_json json;
  FieldWalk walk{FieldWriter(json)};
  T::fields(walk, value);
  return json;
}

template <class T>
[[nodiscard]] T fields_from(const nlohmann::ordered_json& json) {
  T value;
  FieldWalk walk{FieldReader(json)};
  T::fields(walk, value);
  return value;
}

}  // namespace landfall
