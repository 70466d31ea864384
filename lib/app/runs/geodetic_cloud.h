// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "formats/gdal/point_frame.h"
#include "formats/points/cloud_reader.h"

namespace landfall {

/// A cloud of body-fixed x, y, z as one of longitude, latitude (degrees) and height above the ellipsoid
/// (metres). The centre of the body has no place there: NaN.
[[nodiscard]] std::unique_ptr<CloudReader> geodetic_cloud(std::unique_ptr<CloudReader> body_fixed,
                                                          const BodyFixed& frame);

}  // namespace landfall
