// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "raster/region.h"

namespace landfall {

/// One 8-connected component of a mask.
struct Hole {
  std::int32_t id = 0;  ///< from 1, by first bin in row-major order
  std::int64_t size_bins = 0;
  BinIndex first;           ///< in row-major order: the westernmost bin of the southernmost row
  double centroid_x_m = 0;  ///< mean of the bins' centres
  double centroid_y_m = 0;
  BinIndex south_west;  ///< bounding box, both corners inclusive
  BinIndex north_east;
  double largest_distance_bins = 0;  ///< filled by assess_coverage: to the nearest valid bin of the DEM
  friend bool operator==(const Hole&, const Hole&) = default;
};

/// The components of some bins of a grid.
struct BinLabels {
  std::vector<std::int32_t> id;  ///< by bin
  std::vector<Hole> holes;       ///< hole k has id k + 1
};

/// Labels the 8-connected components of bins, which are given by their row-major indices, ascending: with a
/// union-find over provisional labels, in linear time for any shape. Distances are left 0.
[[nodiscard]] BinLabels label_bins(const GridSpec& spec, std::span<const std::uint32_t> bins);

struct HoleLabels {
  Grid<std::int32_t> id;    ///< 0 where the mask is 0
  std::vector<Hole> holes;  ///< hole k has id k + 1
};

/// Labels the 8-connected components of a mask (label_bins()).
[[nodiscard]] HoleLabels label_holes(const BinMask& mask);

}  // namespace landfall
