// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config/json_source.h"

namespace landfall::cli {

/// A source with the defaults of the schema (embedded_schema()) and of what follows from its keys; throws
/// UsageError.
[[nodiscard]] nlohmann::json resolved_config(const JsonSource& source, const std::string& schema);

/// A value of a configuration that is not its default.
struct ConfigChange {
  std::string key;  ///< "noise.range_sigma_m", as --set takes it
  nlohmann::json value;
};

/// Where `config`, resolved by this or another version, differs from the defaults for its choices of "type".
/// Each choice stands among them where it is not the default. Arrays differ as a whole.
[[nodiscard]] std::vector<ConfigChange> config_changes(const nlohmann::json& config,
                                                       const std::string& schema);

}  // namespace landfall::cli
