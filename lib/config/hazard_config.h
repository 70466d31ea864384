// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "hazards/hazard_map.h"

namespace landfall {

/// hazard.json (docs/user/hazard-map.md); the schema checks all bounds that do not depend on the map. Throws
/// UsageError "NAME: /requirements/..." as own_requirements() does, "NAME: /region..." as region_config()
/// does, and "NAME: /sites/reach/..." for a divert that cannot be flown.
[[nodiscard]] HazardParameters hazard_config(const nlohmann::json& resolved,
                                             const std::string& name = "hazard");

}  // namespace landfall
