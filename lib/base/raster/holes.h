// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/raster/region.h"

namespace landfall {

/// One 8-connected component of the set bins of a mask.
struct Hole {
  std::int32_t id = 0;  ///< from 1, in the order of the holes' first bins
  std::int64_t size_bins = 0;
  BinIndex first;           ///< in row-major order: the westernmost of its southernmost row
  double centroid_x_m = 0;  ///< mean of the bins' centres, frame D
  double centroid_y_m = 0;
  BinIndex south_west;  ///< bounding box, both corners inclusive
  BinIndex north_east;
  /// From a bin of the hole to the nearest valid bin of the DEM; 0 until assess_coverage() computes it.
  double depth_bins = 0;
  friend bool operator==(const Hole&, const Hole&) = default;
};

/// The components of a list of bins.
struct BinLabels {
  std::vector<std::int32_t> id;  ///< one for each bin, in the order of the list
  std::vector<Hole> holes;       ///< hole k has id k + 1
};

/// Labels the 8-connected components of `bins`, row-major indices in ascending order. Takes linear time for
/// any shape (union-find over provisional labels). Distances stay 0.
[[nodiscard]] BinLabels label_bins(const GridSpec& spec, std::span<const std::uint32_t> bins);

/// The components of a mask.
struct HoleLabels {
  Grid<std::int32_t> id;    ///< 0 where the mask is 0
  std::vector<Hole> holes;  ///< hole k has id k + 1
};

/// Labels the 8-connected components of a mask (label_bins()).
[[nodiscard]] HoleLabels label_holes(const BinMask& mask);

}  // namespace landfall
