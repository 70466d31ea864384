// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "hazards/hazard_map.h"

namespace landfall {

/// hazard.json (docs/user/hazard-map.md); the schema checks all bounds that do not depend on the map.
[[nodiscard]] HazardParameters hazard_config(const nlohmann::json& resolved);

}  // namespace landfall
