// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "terrain/populations/line_pattern.h"
#include "terrain/populations/patterns.h"

namespace landfall {

// Patterns that scatter objects, from a resolved configuration; `owner` ("patterns/3") begins the message of
// the UsageError for keys that exclude or require each other.
[[nodiscard]] RockPattern golombek_rocks(const nlohmann::json& pattern, const std::string& owner);
[[nodiscard]] RockPattern power_law_rocks(const nlohmann::json& pattern, const std::string& owner);
[[nodiscard]] IceBlockPattern ice_blocks(const nlohmann::json& pattern, const std::string& owner);
[[nodiscard]] CraterPattern craters(const nlohmann::json& pattern, const std::string& owner);
[[nodiscard]] LinePattern lines(const nlohmann::json& pattern, const std::string& owner);

}  // namespace landfall
