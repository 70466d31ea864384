// SPDX-License-Identifier: GPL-3.0-or-later
// Every number of a schema has an upper bound, and a lower one, so that no valid configuration overflows:
// 1e6 m and 1e6 s for errors and times, 1e9 m for sizes and positions, 360 degrees, 1e12 for coordinates
// of a map. They are not the limits of sensible values. What overflows nevertheless is refused when it is
// written. Numbers of a study have no bounds of their own, because they become values of keys.
#include "store/config/schema.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/core/error.h"
#include "base/text/joined.h"
#include "base/text/shown_text.h"
#include "store/config/embedded_composed.h"
#include "store/config/embedded_schemas.h"
#include "store/config/schema_keys.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// For an editor and for a reader; they are not part of the configuration.
constexpr std::array kIgnoredKeys = {"$schema", "$comment"};

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// A value for a message, shortened if it is too long.
std::string shown(const Json& value) { return abbreviated(value.dump()); }

std::string listed(const Json& values) {
  return joined(values, ", ", [](const Json& value) { return value.dump(); });
}

std::string json_type(const Json& value) {
  if (value.is_number_integer()) return "integer";
  return value.is_number() ? "number" : value.type_name();
}

bool has_type(const Json& value, const std::string& type) {
  if (type == "number") return value.is_number();
  if (type == "integer") return value.is_number_integer();
  return value.type_name() == type;
}

/// Walks a schema and a value together.
class Resolver {
 public:
  Resolver(const JsonSource& source, const Json& root) : source_(source), root_(root) {}

  void resolve(const Json& schema_or_ref, Json& value, const std::string& pointer) {
    const Json& schema = dereferenced(schema_or_ref);
    if (schema.contains("oneOf")) {
      if (const std::optional<Json> fallback = default_of(schema_or_ref))
        if (value.is_object() && !value.contains("type") && fallback->contains("type"))
          value["type"] = fallback->at("type");
      resolve(alternative(schema, value, pointer), value, pointer);
      return;
    }
    if (schema.value("type", "") == "integer") make_integer(value);
    check_type(schema, value, pointer);
    check_choice(schema, value, pointer);
    if (value.is_number()) check_bounds(schema, value, pointer);
    if (value.is_string() && value.get_ref<const std::string&>().empty() && schema.value("minLength", 0) > 0)
      fail(pointer, "is empty");
    if (value.is_array()) resolve_array(schema, value, pointer);
    if (value.is_object()) resolve_object(schema, value, pointer);
  }

 private:
  [[noreturn]] void fail(const std::string& pointer, const std::string& what) const {
    throw UsageError(source_.name + ": " + (pointer.empty() ? "/" : pointer) + ": " + what);
  }

  const Json& dereferenced(const Json& node) const { return landfall::dereferenced(root_, node); }

  /// The alternative selected by the value's "type", or by its JSON type.
  const Json& alternative(const Json& schema, const Json& value, const std::string& pointer) const {
    if (!value.is_object()) return alternative_of_json_type(schema, value, pointer);
    Json names = Json::array();
    for (const Json& option : schema["oneOf"]) {
      const Json& choice = dereferenced(option);
      if (!choice.contains("properties") || !choice["properties"].contains("type")) continue;
      const Json& constant = choice["properties"]["type"].at("const");
      if (value.contains("type") && value["type"] == constant) return choice;
      names.push_back(constant);
    }
    if (names.empty()) return alternative_of_json_type(schema, value, pointer);
    if (!value.contains("type")) fail(pointer, "needs a \"type\": one of " + listed(names));
    fail_choice(names, value["type"], pointer + "/type");
  }

  const Json& alternative_of_json_type(const Json& schema, const Json& value,
                                       const std::string& pointer) const {
    std::vector<std::string> wanted;
    const std::vector<std::string> names = type_names(schema);
    for (const Json& option : schema["oneOf"]) {
      const Json& choice = dereferenced(option);
      const std::string type = choice.value("type", "object");
      if (has_type(value, type)) return choice.contains("oneOf") ? option : choice;
      const std::string kind = type == "object" && !names.empty() ? "object with a \"type\"" : type;
      if (std::ranges::find(wanted, kind) == wanted.end()) wanted.push_back(kind);
    }
    std::string message = shown(value) + " is not valid; expected " + joined(wanted, " or ");
    const std::string near = value.is_string() ? nearest_word(value.get<std::string>(), names) : "";
    if (!near.empty())
      message +=
          "; did you mean "
          R"({"type": ")" +
          near + "\"}?";
    fail(pointer, message);
  }

  /// The allowed values of "type" in the objects among the alternatives.
  std::vector<std::string> type_names(const Json& schema) const {
    std::vector<std::string> names;
    for (const Json& option : schema["oneOf"]) {
      const Json& choice = dereferenced(option);
      if (choice.contains("oneOf")) {
        for (std::string& name : type_names(choice)) names.push_back(std::move(name));
      } else if (choice.contains("properties") && choice["properties"].contains("type")) {
        names.push_back(choice["properties"]["type"].at("const").get<std::string>());
      }
    }
    return names;
  }

  [[noreturn]] void fail_choice(const Json& choices, const Json& value, const std::string& pointer) const {
    std::vector<std::string> words;
    for (const Json& choice : choices)
      if (choice.is_string()) words.push_back(choice.get<std::string>());
    const std::string near = value.is_string() ? nearest_word(value.get<std::string>(), words) : "";
    fail(pointer, shown(value) + " is not one of " + listed(choices) +
                      (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
  }

  /// 18.0 is an integer (draft-07), and some writers store integers in this way.
  static void make_integer(Json& value) {
    if (!value.is_number_float()) return;
    const double number = value.get<double>();
    if (std::abs(number) <= 0x1p53 && number == std::floor(number)) value = static_cast<std::int64_t>(number);
  }

  /// " of 3 elements, [.., .., ..]" where the schema fixes their number.
  static std::string form_of_array(const Json& schema) {
    if (!schema.contains("minItems") || schema["minItems"] != schema.value("maxItems", Json())) return "";
    const auto count = schema["minItems"].get<std::size_t>();
    return " of " + std::to_string(count) + " elements, [" + joined(std::vector<std::string>(count, "..")) +
           "]";
  }

  void check_type(const Json& schema, const Json& value, const std::string& pointer) const {
    if (!schema.contains("type")) return;
    const std::string type = schema["type"].get<std::string>();
    if (has_type(value, type)) return;
    fail(pointer, shown(value) + " is of type " + json_type(value) + ", not " + type + form_of_array(schema));
  }

  void check_choice(const Json& schema, const Json& value, const std::string& pointer) const {
    if (schema.contains("const") && value != schema["const"])
      fail(pointer, shown(value) + " is not " + schema["const"].dump());
    if (!schema.contains("enum")) return;
    const Json& choices = schema["enum"];
    if (std::find(choices.begin(), choices.end(), value) == choices.end())
      fail_choice(choices, value, pointer);
  }

  /// Returns both bounds if there are two, so that one message is enough.
  static std::string bounds(const Json& schema) {
    const bool above = schema.contains("exclusiveMinimum");
    const bool below = schema.contains("exclusiveMaximum");
    const bool has_min = above || schema.contains("minimum");
    const bool has_max = below || schema.contains("maximum");
    const std::string minimum = has_min ? number_text(schema[above ? "exclusiveMinimum" : "minimum"]) : "";
    const std::string maximum = has_max ? number_text(schema[below ? "exclusiveMaximum" : "maximum"]) : "";
    if (!has_max) return (above ? "> " : ">= ") + minimum;
    if (!has_min) return (below ? "< " : "<= ") + maximum;
    return std::string("in ") + (above ? "(" : "[") + minimum + ", " + maximum + (below ? ")" : "]");
  }

  void check_bounds(const Json& schema, const Json& value, const std::string& pointer) const {
    const auto breaks = [&](const char* keyword, auto is_outside) {
      return schema.contains(keyword) && is_outside(value, schema[keyword]);
    };
    if (breaks("minimum", std::less<>()) || breaks("maximum", std::greater<>()) ||
        breaks("exclusiveMinimum", std::less_equal<>()) || breaks("exclusiveMaximum", std::greater_equal<>()))
      fail(pointer, shown(value) + " is not " + bounds(schema));
  }

  void resolve_array(const Json& schema, Json& value, const std::string& pointer) {
    const std::size_t size = value.size();
    if (size < schema.value("minItems", std::size_t{0}) || size > schema.value("maxItems", SIZE_MAX)) {
      const bool exact = schema.contains("maxItems") && schema.value("minItems", 0) == schema["maxItems"];
      fail(pointer,
           "an array of " + std::to_string(size) + " elements; expected " +
               (exact                                             ? ""
                : size < schema.value("minItems", std::size_t{0}) ? "at least "
                                                                  : "at most ") +
               (size < schema.value("minItems", std::size_t{0}) ? schema["minItems"] : schema["maxItems"])
                   .dump());
    }
    if (!schema.contains("items")) return;
    for (std::size_t i = 0; i < size; ++i)
      resolve(schema["items"], value[i], pointer + "/" + std::to_string(i));
  }

  void resolve_object(const Json& schema, Json& value, const std::string& pointer) {
    const Json no_properties = Json::object();
    const Json& properties = schema.contains("properties") ? schema["properties"] : no_properties;
    const Json others = schema.value("additionalProperties", Json(false));
    for (auto& [key, inner] : value.items()) {
      if (properties.contains(key)) continue;
      if (others == false) fail_unknown_key(properties, key, pointer);
      if (others.is_object()) resolve(others, inner, pointer + "/" + key);
    }
    if (schema.contains("required"))
      for (const Json& key : schema["required"])
        if (!value.contains(key.get<std::string>())) fail(pointer, "needs the key " + key.dump());
    for (const auto& [key, property] : properties.items()) {
      if (!value.contains(key)) {
        const std::optional<Json> fallback = default_of(property);
        if (!fallback) continue;
        value[key] = *fallback;
      }
      resolve(property, value[key], pointer + "/" + key);
    }
  }

  std::optional<Json> default_of(const Json& property) const {
    if (property.contains("default")) return property["default"];
    const Json& schema = dereferenced(property);
    if (schema.contains("default")) return schema["default"];
    return std::nullopt;
  }

  [[noreturn]] void fail_unknown_key(const Json& properties, const std::string& key,
                                     const std::string& pointer) const {
    std::vector<std::string> known = pointer.empty() ? source_.imported : std::vector<std::string>();
    for (const auto& [name, unused] : properties.items())
      if (!name.starts_with("$")) known.push_back(name);
    const std::string near = nearest_word(key, known);
    std::string hint = near.empty() ? "; known: " + joined(known) : "; did you mean \"" + near + "\"?";
    const auto leftover = source_.leftovers.find(pointer + "/" + key);
    if (leftover != source_.leftovers.end()) hint = "; " + leftover->second;
    fail(pointer + "/" + abbreviated(key), "unknown key" + hint);
  }

  const JsonSource& source_;
  const Json& root_;
};

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= best_distance) continue;
    best_distance = distance;
    best = candidate;
  }
  constexpr std::size_t kMinPart = 4;
  if (best.empty() && word.size() >= kMinPart)
    for (const std::string& candidate : known)
      if (candidate.find(word) != std::string::npos && (best.empty() || candidate.size() < best.size()))
        best = candidate;
  return best;
}

const Json& dereferenced(const Json& schema, const Json& node) {
  if (!node.contains("$ref")) return node;
  const Json::json_pointer where(node["$ref"].get<std::string>().substr(1));
  return dereferenced(schema, schema.at(where));
}

const Json& embedded_schema(const std::string& name) {
  // Each is parsed on its first use, because a tool uses one or two of them.
  static std::mutex mutex;
  static std::map<std::string, Json> parsed;  // whose values stay where they are
  const std::lock_guard lock(mutex);
  const auto known = parsed.find(name);
  if (known != parsed.end()) return known->second;
  for (const auto& schema : embedded::kSchemas)
    if (schema.name == name + ".schema.json") return parsed[name] = Json::parse(schema.text);
  throw std::out_of_range("no schema is named " + name);
}

std::string printed_schema(const std::string& name) {
  for (const auto& schema : embedded::kComposed)
    if (schema.name == name + ".schema.json") return schema.text;
  return embedded_schema(name).dump(2) + "\n";
}

Json resolve_config(const JsonSource& source, const Json& schema) {
  Json value = source.value;
  Resolver(source, schema).resolve(schema, value, "");
  if (value.is_object())
    for (const char* const key : kIgnoredKeys) value.erase(key);
  return value;
}

Json default_at(const Json& config, const Json& schema, const std::string& pointer) {
  try {
    const Json resolved = resolve_config({"", config}, schema);
    const Json::json_pointer where(pointer);
    return resolved.contains(where) ? resolved.at(where) : Json();
  } catch (const UsageError&) {  // the complete configuration is checked later
    return {};
  } catch (const Json::exception&) {  // not a pointer
    return {};
  }
}

}  // namespace landfall
