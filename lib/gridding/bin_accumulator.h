// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/zeroed_memory.h"
#include "gridding/grid_points.h"
#include "gridding/row_partition.h"
#include "raster/grid_spec.h"

namespace landfall {

/// What a bin remembers of its returns: all that the layers of layers.h need. Zero bytes are an empty bin.
struct BinSums {
  double weight;    ///< sum w
  double z_first;   ///< z_est of the bin's first return, m; the next two sums are relative to it
  double w_dz;      ///< sum w (z_est - z_first): small numbers, so that squares do not cancel
  double w_dz_dz;   ///< sum w (z_est - z_first)^2
  double w_x_true;  ///< sum w x_true, and so on
  double w_y_true;
  double w_x_est;
  double w_y_est;
  double w_t;
  std::int32_t count;
};

/// Weighted sums per bin: the DEM construction of Chen et al., Eqs. 8-9 (`bilinear_nearest`).
///
/// A return lands in one bin, the one whose centre is nearest in x and in y by its estimated position
/// (GridSpec::bin_of); it never spreads to neighbours. Its weight is w = (1 - p)(1 - q), p = |x_est - X|/s, q
/// likewise in y, (X, Y) the bin's centre, s the bin's edge: weights lie in [1/4, 1]. The paper leaves the
/// division by s unsaid (docs/decisions.md).
///
/// Sums are in double and each bin adds its returns in the order they came in: the same bits at any number of
/// threads and for any cutting into batches. O(1) per return; 80 bytes per bin, in pages that stay untouched
/// until a return falls on them, and 8 bytes per point of at most 4 M points at a time.
///
/// Another method (a splat to four bins, a median, ...) is another accumulator beside this one: it takes the
/// same GridPoints through RowPartition and offers its own layers.
class BinAccumulator {
 public:
  /// Throws UsageError unless the resolution is finite and positive and rows and columns are at least 1.
  explicit BinAccumulator(const GridSpec& spec);

  /// Adds returns; those outside the grid are counted, not an error. Throws FormatError, naming the first row
  /// and its column, if any of the seven coordinates is not finite; rows are numbered from first_row_number.
  /// What the batch added before is then unspecified.
  void add(const GridPoints& points, std::int64_t first_row_number);

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  /// Row-major, y ascending.
  [[nodiscard]] std::span<const BinSums> bins() const { return bins_.values(); }
  /// Returns in bins, and returns in none.
  [[nodiscard]] std::int64_t inside_count() const { return inside_count_; }
  [[nodiscard]] std::int64_t outside_count() const { return outside_count_; }

 private:
  void add_piece(const GridPoints& points);
  void add_point(const GridPoints& points, std::size_t i);

  GridSpec spec_;
  ZeroedArray<BinSums> bins_;
  RowPartition partition_;
  std::int64_t inside_count_ = 0;
  std::int64_t outside_count_ = 0;
};

}  // namespace landfall
