// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "base/core/progress.h"
#include "chain/ray/engine.h"
#include "chain/terrain/mesh/triangle_mesh.h"
#include "chain/terrain/relief/triangulated_grid.h"

namespace landfall {

/// First hits through CGAL's AABB tree, with the exact predicates of its EPICK kernel: whether a ray meets a
/// triangle, border included, is decided without rounding, so that no ray slips between neighbours.
///
/// The range is the distance to the plane of the hit triangle: in double where its error bound stays below
/// 1e-9 m, in rational arithmetic where the ray is flatter. A ray in a triangle's plane meets it where it
/// enters it; an origin on the surface has range 0. A ray that is not finite misses.
///
/// The traced ray passes through the origin and a second point, whose rounding turns the ray by at most 1e-15
/// rad. Triangles with a NaN corner are omitted. O(log triangles) per ray. The tree takes 72 bytes per
/// triangle; the triangles themselves are computed from the terrain when needed.
///
/// Progress: counting the triangles covers the first tenth. Building the tree takes most of the time and
/// reports nothing until it is done.
[[nodiscard]] std::unique_ptr<RayEngine> make_cgal_engine(std::shared_ptr<const TriangulatedGrid> terrain,
                                                          const ProgressCallback& progress = {});
[[nodiscard]] std::unique_ptr<RayEngine> make_cgal_engine(std::shared_ptr<const TriangleMesh> terrain,
                                                          const ProgressCallback& progress = {});

}  // namespace landfall
