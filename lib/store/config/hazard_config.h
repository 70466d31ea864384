// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "chain/hazards/hazard_map.h"

namespace landfall {

/// hazard.json (docs/user/hazard-map.md); the schema checks all bounds that do not depend on the map. Throws
/// UsageError "NAME: /requirements/..." as own_requirements() does, "NAME: /region..." as region_config()
/// does, and "NAME: /sites/reach/..." for a divert that cannot be flown.
[[nodiscard]] HazardParameters hazard_config(const nlohmann::json& resolved,
                                             const std::string& name = "hazard");

/// Checks that the map of a regrid.json holds and resolves the lander of a hazard.json, both resolved, as
/// hazard-map does with its DEM. Throws UsageError "NAME: /hazard/lander/...", naming the keys of a chain
/// that change either.
void check_hazard_map(const nlohmann::json& hazard, const nlohmann::json& regrid, const std::string& name);

}  // namespace landfall
