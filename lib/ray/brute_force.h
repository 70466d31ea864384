// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "ray/engine.h"
#include "terrain/triangulated_grid.h"

namespace landfall {

/// The oracle of the other engines: tests each ray against every triangle. Slow and obvious.
///
/// The test is Woop, Benthin and Wald's ("Watertight ray/triangle intersection", JCGT 2013) in long double:
/// a triangle's corners are sheared so that the ray becomes an axis, and the signs of three 2-D edge
/// functions decide. Triangles that share a corner see the same sheared corner, and each sign is exact for
/// the sheared corners (ties are settled with fused multiply-adds), so no ray slips between neighbours. The
/// shear rounds: a ray that passes a border of the surface within about 1e-17 of its distance may go either
/// way.
///
/// A ray in a triangle's plane meets it where it enters it. An origin that lies less than 1e-15 m beyond the
/// surface counts as on it: range 0. A ray that is not finite misses. O(triangles) per ray.
[[nodiscard]] std::unique_ptr<RayEngine> make_brute_force_engine(
    std::shared_ptr<const TriangulatedGrid> terrain);

}  // namespace landfall
