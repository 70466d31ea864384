// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/core/parallel.h"
#include "base/raster/grid_spec.h"
#include "chain/gridding/grid_points.h"

namespace landfall {

/// Sorts a batch of points into bands of neighbouring rows, so that bands can be summed in parallel while
/// each bin still sees its points in the order of arrival: sums do not depend on the number of threads. Every
/// gridding method starts with this step.
class RowPartition {
 public:
  /// The largest number of points of a batch: their indices are kept in 32 bits.
  static constexpr std::size_t kMaxPoints = std::size_t{1} << 31U;

  explicit RowPartition(const GridSpec& spec);

  [[nodiscard]] std::size_t band_count() const { return band_count_; }

  /// Writes the rows of points [begin, end) to rows[0], rows[1], ...; any number outside the grid for a point
  /// that belongs to no row. Called for several pieces at once.
  using FindRows = std::function<void(std::size_t begin, std::size_t end, std::int32_t* rows)>;
  /// Sorts `count` <= kMaxPoints points again. 8 bytes per point, kept for the next batch.
  void assign(std::size_t count, const FindRows& find_rows);

  /// assign() by the bin in which a point lies; x and y, metres, have the same length.
  void assign(std::span<const double> x_m, std::span<const double> y_m);

  /// The indices of the points of the band's rows, ascending.
  [[nodiscard]] std::span<const std::uint32_t> points_of_band(std::size_t band) const;
  /// The points that belong to no row.
  [[nodiscard]] std::span<const std::uint32_t> outside_points() const { return points_of_band(band_count_); }
  [[nodiscard]] std::size_t outside_count() const { return outside_points().size(); }

 private:
  void find_bands(const FindRows& find_rows);
  void turn_counts_into_starts(std::size_t pieces);
  void scatter();
  [[nodiscard]] std::size_t slot(std::size_t piece, std::size_t band) const {
    return piece * (band_count_ + 1) + band;
  }

  GridSpec spec_;
  std::size_t band_count_;
  std::vector<std::int32_t> band_of_point_;  ///< band_count_ if outside
  std::vector<std::uint32_t> starts_;        ///< per piece and band: first its count, then its write position
  std::vector<std::uint32_t> band_begins_;
  std::vector<std::uint32_t> order_;
};

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
