// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/points/cloud_reader.h"

namespace landfall {

/// The meaning of the axes of a file.
struct CloudAxes {
  bool latitude_first = false;  ///< its x is the latitude or northing, its y the longitude or easting
  bool y_up = false;            ///< (x, y, z) of the file is (x, -z, y) of the map
};

/// Turns points to x east, y north, z up.
void rotate(const CloudAxes& axes, CloudBatch& batch);
/// The same for the steps and the box that a file declares.
void rotate(const CloudAxes& axes, CloudInfo& info);

}  // namespace landfall
