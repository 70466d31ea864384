// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "config/json_source.h"
#include "raster/grid_spec.h"
#include "terrain/mesh/polygon_soup.h"
#include "terrain/terrain_model.h"

namespace landfall {

/// A mesh file that is the terrain.
struct MeshImport {
  std::string path;
  MeshPlacement placement = {};
};

/// A terrain configuration (docs/user/terrain-gen.md), degrees turned into radians.
struct TerrainConfig {
  GridSpec grid;
  TerrainModel model;
  std::optional<MeshImport> mesh = {};  ///< instead of the two above
};

/// A base of type "dem", resolved.
[[nodiscard]] DemBase dem_base(const nlohmann::json& resolved);

/// resolve_config() by the schema of terrain-gen. A mesh stands instead of grid, base, features and patterns:
/// UsageError where one of them is given beside it; the resolved configuration has none of them then, nor a
/// seed.
[[nodiscard]] nlohmann::json resolve_terrain_config(const JsonSource& source);

/// `resolved` comes from resolve_config(); `name` begins the message of the UsageError that a combination of
/// values makes which the schema cannot refuse.
[[nodiscard]] TerrainConfig terrain_config(const nlohmann::json& resolved, const std::string& name);

}  // namespace landfall
