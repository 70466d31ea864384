// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config/json_source.h"

namespace landfall::cli {

/// Fills a source with the defaults of the schema (embedded_schema()) and those that follow from its keys;
/// throws UsageError.
[[nodiscard]] nlohmann::json resolved_config(const JsonSource& source, const std::string& schema);

/// A value of a configuration that is not its default.
struct ConfigChange {
  std::string key;  ///< "noise.range_sigma_m", as --set takes it
  nlohmann::json value;
};

/// The values of `config`, resolved by this or another version, that differ from the defaults for its choices
/// of "type". Each choice that is not the default is included. Arrays are compared as a whole.
[[nodiscard]] std::vector<ConfigChange> config_changes(const nlohmann::json& config,
                                                       const std::string& schema);

}  // namespace landfall::cli
