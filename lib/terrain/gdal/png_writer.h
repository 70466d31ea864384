// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "raster/rgb_image.h"

namespace landfall {

/// GDAL's side of save_png() (lib/terrain/gdal_loader.h).
void write_png(const std::string& path, const RgbImage& image);

}  // namespace landfall
