// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "ray/pyramid_traversal.h"

namespace landfall {

/// What walk_packets gives for a ray that it leaves to PyramidTraversal.
inline constexpr double kUndecided = -1;

/// Traces rays in SIMD lanes, as far as double precision decides: ranges[i] is what PyramidTraversal answers,
/// to the last bit, or kUndecided. Undecided are rays that start within rounding of a cell's border, that
/// pass so near one where they change cells, that meet a triangle which certain_range leaves open, or that
/// walk on and on. Fast where neighbours in the span start together and point alike, most so downward from
/// above: the walk of each group begins at the highest elevation that the group can meet.
///
/// The instruction set is the best that the machine has, chosen when first called (Highway); the answers are
/// the same on each. Grids of more than 9 * 10^8 nodes are left undecided.
void walk_packets(const Heightfield& field, std::span<const Ray> rays, std::span<double> ranges);

}  // namespace landfall
