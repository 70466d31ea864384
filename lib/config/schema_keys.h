// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace landfall {

/// One key of a configuration, as a person reads it; or, without a `type`, the head of the keys that one
/// choice of "type" has.
struct SchemaKey {
  /// As --set takes it: "scanner.half_width_m"; an N stands for the index in an array, "features.N.x_m".
  std::string path;
  /// What the "type" of the nearest object above that has one must be, "fsm"; empty for a key that does not
  /// depend on one. Of a head: its choice.
  std::string choice;
  std::string type;                 ///< "number", "array of 3 numbers", "object", "any of ..."
  std::string unit;                 ///< by the suffix of the key: "m", "rad", ...; empty where it has none
  std::string bounds;               ///< "> 0, at most 90"; empty without
  std::vector<std::string> values;  ///< the only ones allowed, as JSON
  std::string default_value;        ///< as JSON; empty where there is none
  std::string description;
};

/// All keys of a schema as embedded_schema() gives it, parents first, in the alphabetical order of the
/// schema's keys. A definition that is used several times is written out in the first; in the others its
/// key says where: "as features.N".
[[nodiscard]] std::vector<SchemaKey> schema_keys(const nlohmann::json& schema);

}  // namespace landfall
