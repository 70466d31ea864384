// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "base/core/progress.h"
#include "chain/terrain/mesh/triangle_mesh.h"
#include "chain/terrain/relief/albedo_map.h"
#include "chain/terrain/relief/feature_field.h"
#include "chain/terrain/relief/large_terrain.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "chain/terrain/relief/terrain_strips.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "store/files/landfall_file.h"

namespace landfall {

/// Writes terrain.h5: /x /y /z (float64), /albedo (float32) if the terrain has one, the site frame
/// (docs/user/files/terrain.md) and the list of objects.
void write_terrain(LandfallFileWriter& file, const GeneratedTerrain& terrain);

/// The numbers of nodes of a terrain.
struct NodeCounts {
  std::int64_t nodes = 0;
  std::int64_t holes = 0;  ///< those without an elevation
};
[[nodiscard]] NodeCounts count_nodes(const Grid<double>& grid);

/// Makes a terrain strip by strip and writes the same file. Also throws as TerrainStrips::make() does.
NodeCounts write_terrain(LandfallFileWriter& file, TerrainStrips& strips,
                         const ProgressCallback& progress = {});

/// The id of an imported raster: a hash of the samples, position and frame that were read. Files next to the
/// named one (a world file, the parts of a VRT) affect it only through these; the file's name does not.
[[nodiscard]] std::string raster_id(const DemRaster& raster);

/// Identifies a terrain in the files made from it.
struct TerrainIdentity {
  std::string crs_wkt{};
  std::string file_id{};
  nlohmann::json chain = nlohmann::json::array();
  std::optional<double> spacing_m{};  ///< node_spacing_m()
};

/// The distance between the nodes of a terrain made by this configuration of terrain-gen; nothing for a mesh
/// and for a plane without features, which is exact at any spacing.
[[nodiscard]] std::optional<double> node_spacing_m(const nlohmann::json& config, double resolution_m);

/// Throws FormatError unless the file is a complete terrain; does not read the elevations or the mesh.
[[nodiscard]] TerrainIdentity read_terrain_identity(const std::filesystem::path& path);

/// A terrain in memory.
struct TerrainInput : TerrainIdentity {
  std::shared_ptr<const TerrainSurface> surface{};
  std::shared_ptr<const TriangulatedGrid> grid{};  ///< the surface of a gridded terrain; else null
  std::shared_ptr<const TriangleMesh> mesh{};      ///< the surface of a mesh terrain; else null
  /// The albedo of a terrain made in memory, if it has one; open_albedo() opens that of a file.
  std::shared_ptr<const SurfaceAlbedo> albedo{};
};

/// Throws FormatError unless the file is a complete terrain: gridded, with at least one finite node and no
/// infinite one, or a valid mesh.
[[nodiscard]] TerrainInput read_terrain(const std::filesystem::path& path,
                                        const ProgressCallback& progress = {});

/// Terrains with more nodes are loaded in part.
inline constexpr std::int64_t kMaxLoadedNodes = std::int64_t{1} << 24U;

/// The layer /albedo of a gridded terrain, of which only the tiles in use are loaded; keeps the file open.
/// Throws FormatError unless the file has one; a tile throws it unless all its nodes with an elevation are in
/// [0, 1].
[[nodiscard]] std::unique_ptr<const AlbedoMap> open_albedo(const std::filesystem::path& path);

/// A gridded terrain of which only windows are loaded.
struct LargeTerrainInput : TerrainIdentity {
  LargeTerrain terrain{};  ///< keeps the file open
};

/// Returns nothing for a terrain to be read by read_terrain(): a mesh, a grid of at most `max_nodes` nodes,
/// or a grid for which CellOrigin has no windows. The bounds of the elevations are the layer's actual_range,
/// which terrain-gen writes; without it all tiles are read once. A window throws FormatError for an elevation
/// that is infinite or beyond these bounds.
[[nodiscard]] std::optional<LargeTerrainInput> open_large_terrain(const std::filesystem::path& path,
                                                                  std::int64_t max_nodes = kMaxLoadedNodes,
                                                                  const ProgressCallback& progress = {});

/// Writes /features: one row per object, in their order; no group if there are no objects.
void write_features(const LandfallFileWriter& file, const std::vector<PlacedFeature>& features);

}  // namespace landfall
