// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/key_effects.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

const Json& schema() { return embedded_schema("scan"); }

template <class Value, std::size_t N>
Value named(const std::array<std::pair<const char*, Value>, N>& names, const std::string& word) {
  return std::ranges::find(names, word, [](const auto& entry) { return entry.first; })->second;
}

std::optional<KeyEffect> effect_at(const Json& node, std::optional<KeyEffect> inherited) {
  static constexpr std::array kNames = {std::pair{"beam", KeyEffect::beam},
                                        std::pair{"echo", KeyEffect::echo},
                                        std::pair{"estimate", KeyEffect::estimate}};
  return node.contains("effect") ? std::optional(named(kNames, node["effect"])) : inherited;
}

/// Whether another key has a value with which the keys below this node move the beams.
bool moves_beams_in(const Json& node, const Json& config) {
  if (!node.contains("beam_with")) return false;
  for (const auto& [pointer, value] : node["beam_with"].items()) {
    const Json::json_pointer where(pointer);
    if (config.contains(where) && config.at(where) == value) return true;
  }
  return false;
}

CoveringSigma sigma_at(const Json& node) {
  static constexpr std::array kNames = {
      std::pair{"range", CoveringSigma::range}, std::pair{"given", CoveringSigma::given},
      std::pair{"navigation", CoveringSigma::navigation}, std::pair{"never", CoveringSigma::never}};
  return node.contains("sigma") ? named(kNames, node["sigma"]) : CoveringSigma::none;
}

/// The alternatives of a value; the value's own definition if there is none.
std::vector<const Json*> alternatives(const Json& node) {
  const Json& owner = dereferenced(schema(), node);
  if (!owner.contains("oneOf")) return {&owner};
  std::vector<const Json*> all;
  for (const Json& option : owner["oneOf"])
    for (const Json* const found : alternatives(option)) all.push_back(found);
  return all;
}

/// The first of both in KeyEffect's list; an absent one does not count.
std::optional<KeyEffect> first_of(std::optional<KeyEffect> a, std::optional<KeyEffect> b) {
  if (!a || !b) return a ? a : b;
  return std::min(*a, *b);
}

std::optional<KeyEffect> effect_below(const Json& node, std::optional<KeyEffect> inherited,
                                      std::string_view path) {
  const std::optional<KeyEffect> here = effect_at(node, inherited);
  if (path.empty()) return here;
  const std::size_t end = std::min(path.find('/', 1), path.size());
  const std::string key(path.substr(1, end - 1));
  std::optional<KeyEffect> found;
  for (const Json* const option : alternatives(node))
    if (option->contains("properties") && (*option)["properties"].contains(key))
      found = first_of(found, effect_below((*option)["properties"][key], here, path.substr(end)));
  return found ? found : here;
}

bool is_zero(const Json& value) {
  if (value.is_array()) return !value.empty() && std::ranges::all_of(value, is_zero);
  return value.is_number() && value == 0;
}

bool is_off(const Json& value, const Json& node) {
  if (value.is_null() || !node.contains("default")) return value.is_null();
  return value == node["default"] || (is_zero(value) && is_zero(node["default"]));
}

/// True unless the alternative belongs to another "type".
bool is_chosen(const Json& option, const Json& value) {
  if (!option.contains("properties") || !option["properties"].contains("type")) return true;
  const Json& type = option["properties"]["type"];
  return !type.contains("const") || value.value("type", Json()) == type["const"];
}

class EffectiveKeys {
 public:
  explicit EffectiveKeys(const Json& config) : config_(config) { add(schema(), config, std::nullopt, ""); }
  [[nodiscard]] std::vector<EffectiveKey> take() { return std::move(keys_); }

 private:
  void add(const Json& node, const Json& value, std::optional<KeyEffect> inherited,
           const std::string& pointer) {
    const std::optional<KeyEffect> effect =
        moves_beams_in(node, config_) ? KeyEffect::beam : effect_at(node, inherited);
    const bool is_stated = node.contains("drawn") || node.contains("sigma");
    if (is_stated && !is_off(value, node))
      keys_.push_back({pointer, effect.value(), node.value("drawn", false), sigma_at(node)});
    if (!value.is_object()) return;
    for (const Json* const option : alternatives(node)) {
      if (!option->contains("properties") || !is_chosen(*option, value)) continue;
      for (const auto& [key, inner] : (*option)["properties"].items())
        if (value.contains(key)) add(inner, value[key], effect, pointer + "/" + key);
    }
  }

  const Json& config_;
  std::vector<EffectiveKey> keys_;
};

}  // namespace

std::optional<KeyEffect> effect_of(const std::string& pointer) {
  return effect_below(schema(), std::nullopt, pointer);
}

std::optional<KeyEffect> effect_of(const std::string& pointer, const Json& config) {
  if (pointer.empty()) return effect_of(pointer);
  const Json& sections = schema().at("properties");
  const std::string section = pointer.substr(1, pointer.find('/', 1) - 1);
  if (sections.contains(section) && moves_beams_in(sections[section], config)) return KeyEffect::beam;
  return effect_of(pointer);
}

std::vector<EffectiveKey> keys_in_effect(const Json& config) { return EffectiveKeys(config).take(); }

}  // namespace landfall
