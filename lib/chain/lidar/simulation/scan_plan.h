// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/core/fields.h"
#include "base/raster/grid.h"
#include "chain/lidar/simulation/scan_pipeline.h"

namespace landfall {

/// The outcome of a scan's pulses. The four kinds add up to all pulses.
struct PulseBudget {
  std::int64_t in_region = 0;         ///< pulses with every return in the region
  std::int64_t partly_in_region = 0;  ///< pulses with some returns in the region
  std::int64_t off_region = 0;        ///< fired pulses without a return in the region
  std::int64_t blanked = 0;           ///< pulses that were not fired
  friend bool operator==(const PulseBudget&, const PulseBudget&) = default;
};

/// The result of a scan over known ground: how often it sees each bin, and where its pulses go. Returns are
/// binned by their true position, so errors of the estimate have no effect.
class ScanPlan {
 public:
  /// `region`: 1 for each bin that the scan should cover.
  explicit ScanPlan(Grid<std::int8_t> region);

  /// Adds the next pulses in order of time, with times since the first pulse. The batch must hold all their
  /// pixels.
  void add(const PulseBatch& batch);

  [[nodiscard]] const Grid<std::int8_t>& region() const { return region_; }
  /// Returns in each bin.
  [[nodiscard]] const Grid<std::int32_t>& count() const { return count_; }
  /// Number of pulses with a return in the bin; more than one means overlap.
  [[nodiscard]] const Grid<std::int32_t>& frames() const { return frames_; }
  /// When the bin was first seen, seconds since the first pulse; NaN if never.
  [[nodiscard]] const Grid<float>& first_seen_s() const { return first_seen_s_; }
  [[nodiscard]] const PulseBudget& pulses() const { return pulses_; }
  [[nodiscard]] std::int64_t return_count() const { return return_count_; }
  [[nodiscard]] std::int64_t region_return_count() const { return region_return_count_; }

 private:
  void add_return(std::size_t bin, std::int32_t pulse, double since_start_s);

  Grid<std::int8_t> region_;
  Grid<std::int32_t> count_;
  Grid<std::int32_t> frames_;
  Grid<float> first_seen_s_;
  Grid<std::int32_t> last_pulse_;  ///< last pulse with a return in the bin, -1 before any
  PulseBudget pulses_;
  std::int64_t return_count_ = 0;
  std::int64_t region_return_count_ = 0;
};

/// Plans a whole scan from the batches of run_scan().
[[nodiscard]] ScanPlan plan_scan(const Simulation& simulation, Grid<std::int8_t> region,
                                 std::int64_t points_per_batch, const ProgressCallback& progress = {});

/// The distribution of an integer per bin over the region.
struct BinSpread {
  double mean = 0;
  std::int64_t min = 0;
  std::int64_t p05 = 0;  ///< the smallest value that at least 5 % of the bins do not exceed
  std::int64_t median = 0;
  std::int64_t p95 = 0;
  std::int64_t max = 0;
  double above_one_frac = 0;  ///< fraction of bins with 2 or more
  LANDFALL_FIELDS(mean, min, p05, median, p95, max)
};

/// The region must have a bin and the values be >= 0.
[[nodiscard]] BinSpread spread_over_region(const Grid<std::int32_t>& values, const Grid<std::int8_t>& region);

/// A posting of a DEM, in bins of a plan, and the share of its bins that have a return.
struct FilledPosting {
  std::int64_t bins = 0;
  double filled_frac = 0;
};

/// The finest posting of which at least filled_frac of the bins have a return: blocks of k x k bins, about
/// the origin as those of a DEM, that lie wholly in the region. None if fewer than 100 blocks of every such k
/// lie in it.
[[nodiscard]] std::optional<FilledPosting> finest_posting(const Grid<std::int32_t>& count,
                                                          const Grid<std::int8_t>& region,
                                                          double filled_frac);

}  // namespace landfall
