// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/progress.h"
#include "terrain/gdal/geotiff.h"

namespace landfall {

/// GDAL's side of write_geotiff() (lib/terrain/gdal/gdal_loader.h).
void write_cloud_optimized_geotiff(const std::string& path, const GeotiffContent& content,
                                   const GeotiffOptions& options, const ProgressCallback& progress);

}  // namespace landfall
