// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>

#include "base/progress.h"
#include "io/landfall_file.h"
#include "terrain/terrain_generator.h"
#include "terrain/triangle_mesh.h"
#include "terrain/triangulated_grid.h"

namespace landfall {

/// Writes terrain.h5: /x /y /z (float64), the site frame (SPEC section 8) and the list of objects
/// (feature_file.h).
void write_terrain(LandfallFileWriter& file, const GeneratedTerrain& terrain);

/// The id of an imported raster: a hash of what was read of it, samples, place and frame. Files beside the
/// named one (a world file, the parts of a VRT) count through what they change; the file's name does not.
[[nodiscard]] std::string raster_id(const DemRaster& raster);

/// A terrain as other tools use it.
struct TerrainInput {
  std::shared_ptr<const TerrainSurface> surface;
  std::shared_ptr<const TriangulatedGrid> grid;  ///< the surface, where it is gridded; else null
  std::shared_ptr<const TriangleMesh> mesh;      ///< the surface, where it is a mesh; else null
  std::string crs_wkt;
  std::string file_id;
  nlohmann::json chain;
};

/// Throws FormatError unless the file is a complete terrain: gridded, with at least one finite node and no
/// infinite one, or a sound mesh.
[[nodiscard]] TerrainInput read_terrain(const std::filesystem::path& path,
                                        const ProgressCallback& progress = {});

}  // namespace landfall
