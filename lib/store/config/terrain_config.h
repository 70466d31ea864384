// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/raster/grid_spec.h"
#include "chain/terrain/mesh/polygon_soup.h"
#include "chain/terrain/terrain_model.h"
#include "store/config/json_source.h"

namespace landfall {

/// A mesh file that defines the terrain.
struct MeshImport {
  std::string path;
  MeshPlacement placement = {};
  bool up_is_given = false;  ///< no warning of a mesh that seems to stand on edge
};

/// A terrain configuration (docs/user/terrain-gen.md), with degrees converted to radians.
struct TerrainConfig {
  GridSpec grid;
  TerrainModel model;
  std::optional<MeshImport> mesh = {};  ///< replaces the two above
};

/// A base of type "dem", from its resolved configuration.
[[nodiscard]] DemBase dem_base(const nlohmann::json& resolved);

/// resolve_config() with the schema of terrain-gen. A mesh replaces grid, base, features, patterns
/// and albedo: UsageError if one of them is given with it. The resolved configuration then contains none of
/// them, and no seed.
[[nodiscard]] nlohmann::json resolve_terrain_config(const JsonSource& source);

/// `resolved` comes from resolve_config(); `name` begins the message of the UsageError for a combination of
/// values that the schema cannot refuse.
[[nodiscard]] TerrainConfig terrain_config(const nlohmann::json& resolved, const std::string& name);

}  // namespace landfall
