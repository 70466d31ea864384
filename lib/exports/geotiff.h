// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/progress.h"
#include "output/output_path.h"
#include "terrain/gdal/geotiff.h"

namespace landfall {

/// Writes grids as a cloud-optimized GeoTIFF (save_geotiff() in terrain/gdal/gdal_loader.h) that appears
/// complete or not at all (output_path.h). Throws UsageError if the output exists, IoError if it cannot be
/// written.
void write_geotiff(const OutputOptions& output, const GeotiffContent& content,
                   const ProgressCallback& progress = {});

}  // namespace landfall
