// SPDX-License-Identifier: GPL-3.0-or-later
#include "opencl/device_ground.h"

#include <algorithm>

namespace landfall {

DeviceGround::DeviceGround(const Heightfield& field)
    : cells_per_m(field.frame.cells_per_m),
      anchor(field.frame.anchor),
      first_col(field.frame.first_col),
      first_row(field.frame.first_row),
      extent_cells(field.frame.extent_cells),
      height_m(field.frame.height_m),
      rounding(GridRay::kRounding),
      sharp_m(GridRay::kSharp_m),
      unused(0) {
  const WalkGround walk(field);
  rows = walk.rows;
  cols = walk.cols;
  lowest = walk.lowest;
  highest = walk.highest;
  node_cols = walk.node_cols;
  to_lows = static_cast<std::int64_t>(walk.to_lows);
  top_rung = walk.top_rung;
  std::ranges::copy(walk.size, size.begin());
  std::ranges::copy(walk.per_size, per_size.begin());
  std::ranges::copy(walk.block_cols, block_cols.begin());
  std::ranges::transform(walk.first, first.begin(),
                         [](double block) { return static_cast<std::int64_t>(block); });
}

DeviceField::DeviceField(const Heightfield& field)
    : ground(field),
      bounds(field.pyramid.highs().data(), 2 * field.pyramid.highs().size()),
      nodes(field.terrain.nodes().values()) {}

}  // namespace landfall
