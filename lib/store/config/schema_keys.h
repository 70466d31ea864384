// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace landfall {

/// One key of a configuration, for display. Without a `type` it is the heading of the keys that belong to one
/// choice of "type".
struct SchemaKey {
  /// As --set takes it: "scanner.half_width_m"; N is an array index: "features.N.x_m",
  /// KEY a key of any name: "vary.KEY.sigma".
  std::string path;
  /// The required "type" of the nearest enclosing object that has one, "fsm"; empty for a key that does not
  /// depend on a type. For a heading: its choice.
  std::string choice;
  std::string type;                 ///< "number", "array of 3 numbers", "object", "any of ..."
  std::string unit;                 ///< from the suffix of the key: "m", "rad", ...; empty if it has none
  std::string bounds;               ///< "> 0, at most 90"; empty if there are none
  std::vector<std::string> values;  ///< the only values allowed, as JSON
  std::string default_value;        ///< as JSON; empty if there is none
  std::string description;
};

/// All keys of a schema from embedded_schema(), parents first, in the alphabetical order of the schema's
/// keys. A definition that is used several times is listed under the first key; the others refer to it: "as
/// features.N".
[[nodiscard]] std::vector<SchemaKey> schema_keys(const nlohmann::json& schema);

/// A number of a schema as people write it: 64, 0.5, 1e9.
[[nodiscard]] std::string number_text(const nlohmann::json& number);

}  // namespace landfall
