// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "base/progress.h"
#include "files/landfall_file.h"
#include "terrain/mesh/triangle_mesh.h"
#include "terrain/relief/large_terrain.h"
#include "terrain/relief/terrain_generator.h"
#include "terrain/relief/terrain_strips.h"
#include "terrain/relief/triangulated_grid.h"

namespace landfall {

/// Writes terrain.h5: /x /y /z (float64), the site frame (SPEC section 8) and the list of objects
/// (feature_file.h).
void write_terrain(LandfallFileWriter& file, const GeneratedTerrain& terrain);

/// What was written of a terrain in strips.
struct WrittenNodes {
  std::int64_t count = 0;
  std::int64_t holes = 0;
};

/// Makes a terrain strip by strip and writes the same file. Throws also as TerrainStrips::make().
WrittenNodes write_terrain(LandfallFileWriter& file, TerrainStrips& strips,
                           const ProgressCallback& progress = {});

/// The id of an imported raster: a hash of what was read of it, samples, place and frame. Files beside the
/// named one (a world file, the parts of a VRT) count through what they change; the file's name does not.
[[nodiscard]] std::string raster_id(const DemRaster& raster);

/// Which terrain it is: what files made from it say of it.
struct TerrainIdentity {
  std::string crs_wkt{};
  std::string file_id{};
  nlohmann::json chain = nlohmann::json::array();
};

/// Throws FormatError unless the file is a complete terrain; reads nothing of its ground.
[[nodiscard]] TerrainIdentity read_terrain_identity(const std::filesystem::path& path);

/// A terrain that is in memory.
struct TerrainInput : TerrainIdentity {
  std::shared_ptr<const TerrainSurface> surface{};
  std::shared_ptr<const TriangulatedGrid> grid{};  ///< the surface, where it is gridded; else null
  std::shared_ptr<const TriangleMesh> mesh{};      ///< the surface, where it is a mesh; else null
};

/// Throws FormatError unless the file is a complete terrain: gridded, with at least one finite node and no
/// infinite one, or a sound mesh.
[[nodiscard]] TerrainInput read_terrain(const std::filesystem::path& path,
                                        const ProgressCallback& progress = {});

/// Terrains of more nodes are loaded in part.
inline constexpr std::int64_t kMaxLoadedNodes = std::int64_t{1} << 24U;

/// A gridded terrain of which only windows are loaded.
struct LargeTerrainInput : TerrainIdentity {
  LargeTerrain terrain{};  ///< keeps the file open
};

/// Nothing for a terrain that read_terrain() is for: a mesh, a grid of at most `most_nodes` nodes, or one
/// that CellOrigin has no windows of. The bounds of the elevations are the layer's actual_range, which
/// terrain-gen writes; without it all tiles are read once. A window throws FormatError for an elevation that
/// is infinite or beyond these bounds.
[[nodiscard]] std::optional<LargeTerrainInput> open_large_terrain(const std::filesystem::path& path,
                                                                  std::int64_t most_nodes = kMaxLoadedNodes,
                                                                  const ProgressCallback& progress = {});

}  // namespace landfall
