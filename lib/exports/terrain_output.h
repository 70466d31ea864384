// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "config/terrain_config.h"
#include "files/landfall_file.h"
#include "files/terrain_file.h"
#include "terrain/gdal/raster_links.h"
#include "terrain/mesh/polygon_soup.h"

namespace landfall {

/// A terrain's output and what it needs besides the terrain.
struct TerrainOutput {
  /// Runs a named part of the work and shows its progress.
  using RunPhase =
      std::function<void(const std::string& name, const std::function<void(const ProgressCallback&)>& part)>;

  OutputOptions file;     ///< by its extension .h5, .tif or .tiff (GeoTIFF), .obj or .ply, in any case
  Provenance provenance;  ///< its inputs still to be added
  RunPhase phase;
};

/// What a terrain consists of, as far as it is known.
struct TerrainContent {
  std::optional<NodeCounts> nodes = {};                                 ///< of a gridded one
  std::optional<std::map<std::string, std::int64_t>> features_of = {};  ///< by kind, those that there are
  std::optional<CleanMesh> mesh = {};                                   ///< of an imported one
};

/// The files of the mesh or the rasters that an output at `path` must not replace; what a raster consists of
/// is asked only where there is a file to replace.
[[nodiscard]] std::vector<std::string> input_files(const TerrainConfig& config,
                                                   const std::filesystem::path& path, RasterLinks links);

/// Makes the terrain of a configuration and writes it; one of more than StripSize::most_nodes nodes, as .h5,
/// strip by strip. Throws UsageError where the output's extension is of no format or a mesh would become a
/// GeoTIFF, and what generate_terrain(), read_mesh_file(), clean_mesh() and the writers throw.
TerrainContent build_terrain(const TerrainConfig& config, RasterLinks links, TerrainOutput output);

/// Writes the terrain of a terrain.h5 in another format. Throws UsageError where the output's extension is
/// .h5, and as build_terrain() and read_terrain().
TerrainContent export_terrain(const std::string& path, const TerrainOutput& output);

}  // namespace landfall
