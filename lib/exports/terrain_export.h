// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "base/progress.h"
#include "files/landfall_file.h"
#include "terrain/gdal/geotiff.h"

namespace landfall {

/// The files that a terrain can be written as.
enum class TerrainFormat { landfall, geotiff, mesh };

/// The format that an output's extension means, whatever its case. Throws UsageError, naming those that are
/// known, for any other.
[[nodiscard]] TerrainFormat terrain_format(const std::filesystem::path& output);

/// Writes grids as a cloud-optimized GeoTIFF (save_geotiff() in terrain/gdal/gdal_loader.h) that appears
/// whole or not at all (output_path.h). Throws UsageError where the output exists, IoError when it cannot be
/// written.
void write_geotiff(const OutputOptions& output, const GeotiffContent& content,
                   const ProgressCallback& progress = {});

/// True where `path` names an HDF5 file that some landfall tool has begun: not necessarily a terrain, nor
/// complete.
[[nodiscard]] bool is_landfall_file(const std::filesystem::path& path);

}  // namespace landfall
