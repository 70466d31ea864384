// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "formats/points/point_sample.h"

namespace landfall {

/// The step in which the coordinates of a sample move, in their unit: most of the distances between two
/// neighbouring values are multiples of it. 0 where there is none, and for less than nine values that are far
/// apart for their size, such as lines of points. Sorts the values.
[[nodiscard]] double step_of(std::vector<double>& values);

/// How far apart points are: the square root of the area per point, in the unit of x and y; 0 where they
/// cover no area.
[[nodiscard]] double spacing_of(const PointSample& sample);

/// A warning, without the file's name, where coordinates move in steps of more than a tenth of the spacing of
/// the points: they were stored as float32 or with few digits. Empty for fewer than 64 points, and for a
/// raster of points, whose steps are its spacing, unless the steps are those of `is_float32`, the axes that
/// the file declares as such. `z_unit` is the unit of z in that of x and y; 0: not comparable, z is not
/// judged.
[[nodiscard]] std::string coarse_steps(const PointSample& sample, double z_unit,
                                       const std::array<bool, 3>& is_float32);

}  // namespace landfall
