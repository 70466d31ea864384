// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/core/progress.h"
#include "chain/ray/engine.h"
#include "chain/ray/pyramid_traversal.h"
#include "chain/terrain/relief/triangulated_grid.h"

namespace landfall {

/// First hits on a gridded terrain, without a tree of triangles: a pyramid of elevation bounds shows where a
/// ray may meet the surface, so that few triangles are tested.
///
/// Double precision decides wherever its error bounds allow. WatertightRay decides for a triangle that a ray
/// passes within rounding of an edge, grazes, or starts on. So no ray slips between neighbours, and hits and
/// misses equal those of the oracle. Ranges err by less than 1e-9 m. A ray in a triangle's plane meets the
/// triangle where it enters it; an origin on the surface has range 0. A ray that is not finite misses. The
/// answer to a ray does not depend on the other rays of the call.
///
/// Construction is O(nodes) and reports progress by rows. It takes 8.7 bytes per node besides the terrain.
[[nodiscard]] std::unique_ptr<RayEngine> make_heightfield_engine(
    std::shared_ptr<const TriangulatedGrid> terrain, const ProgressCallback& progress = {});

/// Traces the rays whose ranges[i] is kUndecided (chain/ray/packet_walk.h), alone and at the highest
/// precision that each needs. Returns their number.
std::size_t trace_undecided(const Heightfield& field, std::span<const Ray> rays, std::span<double> ranges);

}  // namespace landfall
