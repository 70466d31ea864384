// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "ray/engine.h"
#include "terrain/mesh/triangle_mesh.h"
#include "terrain/relief/triangulated_grid.h"

namespace landfall {

/// The oracle of the other engines: it tests each ray against every triangle. Slow and obvious.
///
/// The intersection test is WatertightRay. A ray that is not finite misses. O(triangles) per ray.
[[nodiscard]] std::unique_ptr<RayEngine> make_brute_force_engine(
    std::shared_ptr<const TriangulatedGrid> terrain);
[[nodiscard]] std::unique_ptr<RayEngine> make_brute_force_engine(std::shared_ptr<const TriangleMesh> terrain);

}  // namespace landfall
