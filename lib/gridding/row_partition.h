// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "raster/grid_spec.h"

namespace landfall {

/// Sorts a batch of points into bands of neighbouring rows, so that bands can be summed in parallel while
/// each bin still sees its points in the order they came in: sums do not depend on the number of threads.
/// Whatever gathers points by bin, by whichever method, starts here.
class RowPartition {
 public:
  /// The most points of one batch: their numbers are kept in 32 bits.
  static constexpr std::size_t kMaxPoints = std::size_t{1} << 31U;

  explicit RowPartition(const GridSpec& spec);

  [[nodiscard]] std::size_t band_count() const { return band_count_; }

  /// Sorts the points anew; x and y, metres, have one length <= kMaxPoints. 8 bytes per point, kept for the
  /// next batch.
  void assign(std::span<const double> x_m, std::span<const double> y_m);

  /// The numbers of the points whose bin lies in the band, ascending.
  [[nodiscard]] std::span<const std::uint32_t> points_of_band(std::size_t band) const;
  /// How many points lie in no bin.
  [[nodiscard]] std::size_t outside_count() const;

 private:
  void find_bands(std::span<const double> x_m, std::span<const double> y_m);
  void turn_counts_into_starts(std::size_t pieces);
  void scatter();
  [[nodiscard]] std::size_t slot(std::size_t piece, std::size_t band) const {
    return piece * (band_count_ + 1) + band;
  }

  GridSpec spec_;
  std::size_t band_count_;
  std::vector<std::uint32_t> band_of_point_;  ///< band_count_ if outside
  std::vector<std::uint32_t> starts_;         ///< per piece and band: first its count, then where it writes
  std::vector<std::uint32_t> band_begins_;
  std::vector<std::uint32_t> order_;
};

}  // namespace landfall
