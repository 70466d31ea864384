// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "config/json_source.h"

namespace landfall {

/// A configuration of this schema as its tool resolves it: with all defaults, those of a terrain's and a
/// scan's that depend on other keys included. Throws UsageError as resolve_config() does.
[[nodiscard]] nlohmann::json resolved_config(const JsonSource& source, const std::string& schema);

}  // namespace landfall
