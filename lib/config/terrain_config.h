// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "raster/grid_spec.h"
#include "terrain/terrain_model.h"

namespace landfall {

/// A terrain configuration (SPEC section 3), degrees turned into radians.
struct TerrainConfig {
  GridSpec grid;
  TerrainModel model;
};

/// A base of type "dem", resolved.
[[nodiscard]] DemBase dem_base(const nlohmann::json& resolved);

/// `resolved` comes from resolve_config(); `name` begins the message of the UsageError that a combination of
/// values makes which the schema cannot refuse.
[[nodiscard]] TerrainConfig terrain_config(const nlohmann::json& resolved, const std::string& name);

}  // namespace landfall
