// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "base/progress.h"
#include "ray/engine.h"
#include "terrain/relief/triangulated_grid.h"

namespace landfall {

/// First hits on a gridded terrain, without a tree of triangles: a pyramid of the surface's bounds tells
/// where a ray may meet it, and few triangles are ever looked at.
///
/// Double precision decides wherever its error bounds let it; a triangle that a ray passes within rounding of
/// an edge, or grazes, or starts on, is judged by WatertightRay. So no ray slips between neighbours, and hit
/// or miss is that of the oracle. Ranges err by less than 1e-9 m. A ray in a triangle's plane meets it where
/// it enters it; an origin on the surface has range 0. A ray that is not finite misses. The answer to a ray
/// does not depend on the other rays of the call.
///
/// Preparing is O(nodes), with progress by rows; 8.7 bytes per node beyond the terrain's own.
[[nodiscard]] std::unique_ptr<RayEngine> make_heightfield_engine(
    std::shared_ptr<const TriangulatedGrid> terrain, const ProgressCallback& progress = {});

}  // namespace landfall
