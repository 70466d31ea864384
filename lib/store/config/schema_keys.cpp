// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/schema_keys.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include "base/text/joined.h"
#include "base/text/key_unit.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

std::string shown_value(const Json& value) { return value.is_number() ? number_text(value) : value.dump(); }

std::string bounds_of(const Json& schema) {
  std::string text;
  const auto add = [&](const char* keyword, const char* words) {
    if (schema.contains(keyword))
      text += (text.empty() ? "" : ", ") + std::string(words) + shown_value(schema[keyword]);
  };
  add("minimum", "at least ");
  add("exclusiveMinimum", "above ");
  add("maximum", "at most ");
  add("exclusiveMaximum", "below ");
  return text;
}

class Walk {
 public:
  explicit Walk(const Json& root) : root_(root) {}

  [[nodiscard]] std::vector<SchemaKey> keys() && {
    properties(root_, "", "");
    return std::move(keys_);
  }

 private:
  const Json& dereferenced(const Json& node) const { return landfall::dereferenced(root_, node); }

  /// The "type" that selects an alternative; empty if it has none.
  std::string choice_of(const Json& schema) const {
    const Json& s = dereferenced(schema);
    if (!s.contains("properties") || !s["properties"].contains("type")) return "";
    return s["properties"]["type"].value("const", "");
  }

  [[nodiscard]] static std::string plural(const std::string& type) { return type + "s"; }

  std::string type_of(const Json& schema) const {
    const Json& s = dereferenced(schema);
    if (s.contains("oneOf")) return alternatives(s["oneOf"]);
    if (s.contains("enum") || s.contains("const")) return "text";
    std::string type = s.value("type", "object");
    if (type == "string") return "text";
    if (type != "array" || !s.contains("items")) return type;
    const bool exact = s.contains("maxItems") && s.value("minItems", 0) == s["maxItems"];
    return "array of " + (exact ? s["maxItems"].dump() + " " : std::string()) + plural(type_of(s["items"]));
  }

  std::string alternatives(const Json& options) const {
    std::vector<std::string> types;
    for (const Json& option : options)
      if (std::string type = type_of(option); std::find(types.begin(), types.end(), type) == types.end())
        types.push_back(std::move(type));
    return joined(types, " or ");
  }

  void properties(const Json& schema, const std::string& path, const std::string& choice) {
    if (!schema.contains("properties")) return;
    for (const auto& [name, property] : schema["properties"].items())
      if (name != "type" || choice.empty()) key(property, path.empty() ? name : path + "." + name, choice);
  }

  void key(const Json& schema, const std::string& path, const std::string& choice) {
    const Json& s = dereferenced(schema);
    SchemaKey key;
    key.path = path;
    key.choice = choice;
    key.type = type_of(s);
    key.unit = unit_of_key(path);
    // for an array: of each element
    const Json& element = s.contains("items") ? dereferenced(s["items"]) : s;
    key.bounds = bounds_of(element);
    if (element.contains("enum"))
      for (const Json& value : element["enum"]) key.values.push_back(value.dump());
    for (const Json* const source : {&s, &schema}) {
      if (source->contains("default")) key.default_value = shown_value((*source)["default"]);
      if (source->contains("description")) key.description = (*source)["description"].get<std::string>();
    }
    if (key.default_value == "{}") key.default_value.clear();
    const bool repeated = stands_elsewhere(schema, path, key);
    keys_.push_back(key);
    if (!repeated) below(s, path, choice);
  }

  /// True if the keys below were already listed under another key.
  bool stands_elsewhere(const Json& schema, const std::string& path, SchemaKey& key) {
    const Json& s = dereferenced(schema);
    const Json& target = s.contains("items") ? s["items"] : schema;
    if (!target.contains("$ref") || type_of(target).find("object") == std::string::npos) return false;
    const std::string here = s.contains("items") ? path + ".N" : path;
    const auto [found, first] = written_.try_emplace(target["$ref"].get<std::string>(), here);
    if (!first) key.type += ", as " + found->second;
    return !first;
  }

  void below(const Json& s, const std::string& path, const std::string& choice) {
    if (s.contains("oneOf"))
      choices(s["oneOf"], path, choice);
    else if (s.contains("items"))
      elements(s["items"], path + ".N", choice);
    else if (s.contains("additionalProperties") && s["additionalProperties"].is_object())
      elements(s["additionalProperties"], path + ".KEY", choice);  // keys of any name
    else
      properties(s, path, choice);
  }

  /// Does nothing if the array is one of several alternatives and its elements are another.
  void elements(const Json& items, const std::string& path, const std::string& choice) {
    if (items.contains("$ref")) {
      const auto found = written_.find(items["$ref"].get<std::string>());
      if (found != written_.end() && found->second != path) return;
    }
    below(dereferenced(items), path, choice);
  }

  void choices(const Json& options, const std::string& path, const std::string& outer) {
    SchemaKey type{path + ".type", outer, "text", "", "", {}, "", "What it is; decides which keys it has"};
    for (const Json& option : options)
      if (const std::string name = choice_of(option); !name.empty()) type.values.push_back(Json(name).dump());
    if (!type.values.empty()) keys_.push_back(type);
    for (const Json& option : options) {
      const Json& s = dereferenced(option);
      const std::string name = choice_of(option);
      if (!name.empty()) keys_.push_back({path, name, "", "", "", {}, "", s.value("description", "")});
      if (option.contains("$ref") && s.value("type", "") != "number")
        written_.try_emplace(option["$ref"].get<std::string>(), path);
      below(s, path, name.empty() ? outer : name);
    }
  }

  const Json& root_;
  std::vector<SchemaKey> keys_;
  std::map<std::string, std::string> written_;  ///< definitions, and the path under which each is listed
};

}  // namespace

std::vector<SchemaKey> schema_keys(const Json& schema) { return Walk(schema).keys(); }

std::string number_text(const Json& number) {
  constexpr double kLong = 1e6;
  const double value = number.get<double>();
  std::string text = number.dump();
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.begin(), digits.end(), value, std::chars_format::scientific).ptr;
  const std::string scientific(digits.begin(), end);  // 1e+06
  if (std::abs(value) >= kLong && scientific.find('.') == std::string::npos) {
    const std::size_t plus = scientific.find('+');
    text = scientific.substr(0, plus) + scientific.substr(scientific.find_first_not_of("+0", plus));
  }
  return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
}

}  // namespace landfall
