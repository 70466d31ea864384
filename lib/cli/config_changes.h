// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace landfall::cli {

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
