// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "store/config/json_source.h"

namespace landfall {

/// A configuration of this schema as its tool resolves it: with all defaults, those of a terrain's and a
/// scan's that depend on other keys included. Throws UsageError as resolve_config() does.
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

}  // namespace landfall
