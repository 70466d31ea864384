// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/resolved_config.h"

#include "base/core/error.h"
#include "store/config/scan_config.h"
#include "store/config/schema.h"
#include "store/config/terrain_config.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// Extracts only the choices: every "type" of every object.
Json choices_of(const Json& config) {
  Json choices = Json::object();
  for (const auto& [key, value] : config.items()) {
    if (key == "type")
      choices[key] = value;
    else if (value.is_object())
      if (Json below = choices_of(value); !below.empty()) choices[key] = std::move(below);
  }
  return choices;
}

/// The defaults for these choices; those without choices if the chosen types have required keys.
Json defaults_of(const Json& choices, const std::string& schema) {
  try {
    return resolved_config({"defaults", choices}, schema);
  } catch (const UsageError&) {
    return resolved_config({"defaults", Json::object()}, schema);
  }
}

/// The values compared at one node of the configuration.
struct Node {
  const Json& value;
  const Json& of_choices;  ///< the defaults for its choices of "type"
  const Json& plain;       ///< the defaults without any choice
};

const Json& member_of(const Json& value, const std::string& key) {
  static const Json kNone;
  return value.is_object() && value.contains(key) ? value[key] : kNone;
}

void add_changes(const Node& node, const std::string& path, std::vector<ConfigChange>& changes) {
  for (const auto& [key, value] : node.value.items()) {
    const std::string name = path.empty() ? key : path + "." + key;
    const Json& plain = member_of(node.plain, key);
    const Json& expected = key == "type" ? plain : member_of(node.of_choices, key);
    if (value.is_object() && expected.is_object())
      add_changes({value, expected, plain}, name, changes);
    else if (value != expected)
      changes.push_back({name, value});
  }
}

}  // namespace

Json resolved_config(const JsonSource& source, const std::string& schema) {
  if (schema == "terrain") return resolve_terrain_config(source);
  Json config = resolve_config(source, embedded_schema(schema));
  return schema == "scan" ? completed_scan_config(std::move(config)) : config;
}

// Differences of a configuration are relative to the defaults of the chosen types, and every non-default
// choice is one of them. Otherwise a different scanner would list all of its keys.
std::vector<ConfigChange> config_changes(const Json& config, const std::string& schema) {
  std::vector<ConfigChange> changes;
  if (!config.is_object()) return changes;
  const Json plain = resolved_config({"defaults", Json::object()}, schema);
  add_changes({config, defaults_of(choices_of(config), schema), plain}, "", changes);
  return changes;
}

}  // namespace landfall
