// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "raster/grid_spec.h"

namespace landfall {

/// Points `begin` to `begin + count`.
struct PointRun {
  std::uint32_t begin;
  std::uint32_t count;
  friend bool operator==(const PointRun&, const PointRun&) = default;
};

/// RowPartition for points that come in runs, many in a row of the same band, as a scanner makes them: it
/// lists runs, not points, so that their coordinates are read as they lie.
class RunPartition {
 public:
  static constexpr std::size_t kMaxPoints = std::size_t{1} << 31U;

  explicit RunPartition(const GridSpec& spec);

  [[nodiscard]] std::size_t band_count() const { return band_count_; }
  /// Sorts points anew by the bin in which each lies; x and y, metres, have one length, at most kMaxPoints.
  /// Up to 24 bytes per point, kept for the next batch.
  void assign(std::span<const double> x_m, std::span<const double> y_m);

  /// The points of the band's rows, ascending; those that lie in no bin for band_count().
  [[nodiscard]] std::span<const PointRun> runs_of_band(std::size_t band) const;

 private:
  struct BandRun {
    std::uint32_t band;
    PointRun run;
  };
  /// What one thread finds in neighbouring points.
  struct Piece {
    std::vector<BandRun> runs;
    std::vector<std::uint32_t> next;  ///< per band: its number of runs, then where the next one goes
  };
  void find_runs(std::size_t begin, std::span<const std::int32_t> rows, Piece& piece) const;
  void turn_counts_into_places();

  GridSpec spec_;
  std::size_t band_count_;
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> band_begins_;
  std::vector<PointRun> runs_;
};

}  // namespace landfall
