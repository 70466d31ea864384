// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "ray/walk_data.h"

namespace landfall {

/// The numbers of a heightfield that each ray needs on a device: Ground in walk.cl, with the same layout, all
/// members of eight bytes. The constants of GridRay are part of it, so that they are written once.
struct DeviceGround {
  static constexpr std::size_t kRungs = WalkGround::kMaxRungs;

  double cells_per_m, anchor, first_col, first_row, extent_cells, height_m;  ///< GridFrame
  double rounding, sharp_m;                                                  ///< GridRay
  double rows, cols, lowest, highest;                                        ///< WalkGround
  std::int64_t node_cols, to_lows, top_rung, unused;
  std::array<double, kRungs> size, per_size, block_cols;
  std::array<std::int64_t, kRungs> first;

  explicit DeviceGround(const Heightfield& field);
};
static_assert(sizeof(DeviceGround) == 8 * (16 + 4 * DeviceGround::kRungs));

/// A heightfield in the memory of a device.
struct DeviceField {
  DeviceGround ground;
  std::span<const float> bounds;  ///< ElevationPyramid::highs, then lows
  std::span<const double> nodes;

  explicit DeviceField(const Heightfield& field);
};

}  // namespace landfall
