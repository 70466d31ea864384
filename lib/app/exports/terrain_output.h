// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "chain/terrain/mesh/polygon_soup.h"
#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/relief/site_fit.h"
#include "store/config/terrain_config.h"
#include "store/files/landfall_file.h"
#include "store/files/meeting.h"
#include "store/files/terrain_file.h"

namespace landfall {

/// How the rasters of a terrain are read.
struct RasterRules {
  RasterLinks links = RasterLinks::refused;
  MeetingRules meeting = {};
};

/// A terrain's output and the data that it needs besides the terrain.
struct TerrainOutput {
  OutputOptions file;     ///< by its extension .h5, .tif or .tiff (GeoTIFF), .obj or .ply, in any case
  Provenance provenance;  ///< without its inputs, which are added later
  PhaseRunner phase;
};

/// The content of a terrain, as far as it is known.
struct TerrainContent {
  std::optional<NodeCounts> nodes = {};                                 ///< of a gridded one
  std::optional<std::map<std::string, std::int64_t>> features_of = {};  ///< objects by kind
  std::optional<CleanMesh> mesh = {};                                   ///< of an imported one
  /// Remarks on a site that does not suit its raster; the parts of a mesh file that are not read.
  std::vector<std::string> warnings = {};
};

/// fit_dem_site() for a raster that is screened before GDAL opens it (screen_raster()).
[[nodiscard]] SiteSize fit_site_of(const DemBase& dem, const SiteRequest& request,
                                   RasterLinks links = RasterLinks::refused);

/// The files of the mesh or of the rasters, which an output at `path` must not replace. The files of a raster
/// are looked up only if there is a file to replace.
[[nodiscard]] std::vector<std::string> input_files(const TerrainConfig& config,
                                                   const std::filesystem::path& path, RasterLinks links);

/// Makes the terrain of a configuration and writes it; a terrain of more than StripSize::max_nodes nodes is
/// written to .h5 strip by strip. Throws UsageError if the output's extension is unknown or if the output for
/// a mesh is a GeoTIFF, and as generate_terrain(), read_mesh_file(), clean_mesh() and the writers do.
TerrainContent build_terrain(const TerrainConfig& config, const RasterRules& rules, TerrainOutput output);

/// Makes the terrain of a configuration in memory, with the values that terrain.h5 would hold, and no
/// identity. Adds its rasters or its mesh to the inputs of `provenance`. `warn` gets
/// TerrainContent::warnings. Throws as generate_terrain(), read_mesh_file() and clean_mesh() do.
[[nodiscard]] TerrainInput make_terrain(const TerrainConfig& config, const MeetingRules& rules,
                                        Provenance& provenance,
                                        const std::function<void(const std::string&)>& warn);

/// Writes the terrain of a terrain.h5 in another format. Throws UsageError if the output's extension is .h5,
/// and as build_terrain() and read_terrain() do.
TerrainContent export_terrain(const std::string& path, const TerrainOutput& output);

}  // namespace landfall
