// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/raster/grid_spec.h"

namespace landfall {

/// The corners of the convex hull of finite points, counterclockwise; of points on one line its two ends, of
/// one point that point. Exact (CGAL).
[[nodiscard]] std::vector<Horizontal> convex_hull(const std::vector<Horizontal>& points);

}  // namespace landfall
