// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "raster/grid_spec.h"

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

}  // namespace landfall
