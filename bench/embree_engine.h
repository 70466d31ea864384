// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "chain/ray/engine.h"
#include "chain/terrain/relief/triangulated_grid.h"

namespace landfall {

/// The reference of the heightfield engine: Embree 3, coherent packets of 16 rays, the hit selected in
/// single precision and its range refined in double. Not watertight against the stored surface, so it is no
/// engine of the tools.
[[nodiscard]] std::unique_ptr<RayEngine> make_embree_engine(std::shared_ptr<const TriangulatedGrid> terrain);

}  // namespace landfall
