// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "chain/ray/pyramid_traversal.h"

namespace landfall {

/// The result of walk_packets for a ray that it leaves to PyramidTraversal.
inline constexpr double kUndecided = -1;

/// Traces rays in SIMD lanes as far as double precision decides: ranges[i] equals PyramidTraversal's answer
/// to the last bit, or is kUndecided. Undecided are rays that start within rounding of a cell's border, that
/// pass too close to one where they change cells, that meet a triangle which certain_range leaves open, or
/// that take too many steps. Fast where neighbours in the span start and point alike, most so downwards: the
/// walk of each group begins at the highest elevation that the group can meet.
///
/// The instruction set is the best of the machine, chosen at the first call (Highway); the answers are the
/// same on each. Grids of more than 9 * 10^8 nodes are left undecided.
void walk_packets(const Heightfield& field, std::span<const Ray> rays, std::span<double> ranges);

}  // namespace landfall
