// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "terrain/gdal/point_layer.h"

namespace landfall {

/// GDAL's side of write_geopackage() (lib/terrain/gdal/gdal_loader.h).
void write_geopackage_points(const std::string& path, const PointLayer& layer);

}  // namespace landfall
