// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "raster/rgb_image.h"

namespace landfall {

/// GDAL's side of encode_png() (lib/terrain/gdal/gdal_loader.h).
[[nodiscard]] std::string png_bytes(const RgbImage& image);

}  // namespace landfall
