// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "gridding/grid_points.h"
#include "gridding/row_partition.h"

namespace landfall {

/// The number of points per pass: the partition's own memory stays at 48 MB for any size of batch.
inline constexpr std::size_t kPointsPerPass = std::size_t{1} << 22U;

/// Distributes the returns for a method in which each return falls in the bin with the nearest centre.
class NearestBins {
 public:
  /// The grid must have at most 2^31 - 1 bins.
  explicit NearestBins(const GridSpec& spec) : spec_(spec), partition_(spec) {}

  /// Calls add(spec, points, i, bin) for every return i in a bin (its row-major number), bands of rows in
  /// parallel, each bin's returns in order. Returns how many lie in no bin.
  template <class Add>
  std::size_t for_each(const GridPoints& points, const Add& add) {
    std::size_t outside = 0;
    for (std::size_t begin = 0; begin < points.size(); begin += kPointsPerPass) {
      const GridPoints piece = points.subset(begin, std::min(kPointsPerPass, points.size() - begin));
      outside += thread_count() == 1 ? add_in_order(piece, add) : add_by_bands(piece, add);
    }
    return outside;
  }

 private:
  // The loops work on a copy of the grid: it can stay in registers while bins are written, and the compiler
  // sees that a weight divides by the same resolution as the search for the bin.

  template <class Add>
  std::size_t add_in_order(const GridPoints& points, const Add& add) {
    const GridSpec spec = spec_;
    std::size_t outside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const BinIndex bin = spec.bin_of(points.x_est[i], points.y_est[i]);
      if (spec.contains(bin)) {
        add(spec, points, i, spec.index(bin));
      } else {
        ++outside;
      }
    }
    return outside;
  }

  template <class Add>
  std::size_t add_by_bands(const GridPoints& points, const Add& add) {
    const GridSpec spec = spec_;
    bins_.resize(points.size());
    partition_.assign(points.size(), [&, spec](std::size_t begin, std::size_t end, std::int32_t* rows) {
      for (std::size_t i = begin; i < end; ++i) {
        const BinIndex bin = spec.bin_of(points.x_est[i], points.y_est[i]);
        const bool inside = spec.contains(bin);
        bins_[i] = inside ? static_cast<std::int32_t>(spec.index(bin)) : -1;
        rows[i - begin] = inside ? static_cast<std::int32_t>(bin.row) : -1;
      }
    });
    parallel_for(partition_.band_count(), 1, [&, spec](std::size_t band, std::size_t) {
      for (const std::uint32_t i : partition_.points_of_band(band))
        add(spec, points, i, static_cast<std::size_t>(bins_[i]));
    });
    return partition_.outside_count();
  }

  GridSpec spec_;
  RowPartition partition_;
  std::vector<std::int32_t> bins_;
};

}  // namespace landfall
