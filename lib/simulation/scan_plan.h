// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raster/grid.h"
#include "simulation/scan_pipeline.h"

namespace landfall {

/// What became of a scan's pulses. The four kinds add up to all pulses.
struct PulseBudget {
  std::int64_t in_region = 0;         ///< every return in the region
  std::int64_t partly_in_region = 0;  ///< some
  std::int64_t off_region = 0;        ///< fired, none
  std::int64_t blanked = 0;           ///< not fired
  friend bool operator==(const PulseBudget&, const PulseBudget&) = default;
};

/// What a scan would do on known ground: how often it sees each bin, and where its pulses go. Returns are
/// binned by their true place, so errors in the estimate change nothing.
class ScanPlan {
 public:
  /// `region`: 1 for each bin that the scan is for.
  explicit ScanPlan(Grid<std::int8_t> region);

  /// Adds the next pulses, all of whose pixels the batch holds, in order of time.
  void add(const PulseBatch& batch);

  [[nodiscard]] const Grid<std::int8_t>& region() const { return region_; }
  /// Returns in each bin.
  [[nodiscard]] const Grid<std::int32_t>& count() const { return count_; }
  /// Pulses that have a return in the bin: more than one is overlap.
  [[nodiscard]] const Grid<std::int32_t>& images() const { return images_; }
  /// When the bin was first seen, seconds, as the pulse table's t; NaN where never.
  [[nodiscard]] const Grid<float>& first_seen_s() const { return first_seen_s_; }
  [[nodiscard]] const PulseBudget& pulses() const { return pulses_; }
  [[nodiscard]] std::int64_t return_count() const { return return_count_; }
  [[nodiscard]] std::int64_t region_return_count() const { return region_return_count_; }

 private:
  void add_return(std::size_t bin, std::int32_t pulse, double t_s);

  Grid<std::int8_t> region_;
  Grid<std::int32_t> count_;
  Grid<std::int32_t> images_;
  Grid<float> first_seen_s_;
  Grid<std::int32_t> last_pulse_;  ///< that had a return in the bin, -1 before any
  PulseBudget pulses_;
  std::int64_t return_count_ = 0;
  std::int64_t region_return_count_ = 0;
};

/// The plan of a whole scan, of run_scan()'s batches.
[[nodiscard]] ScanPlan plan_scan(const Simulation& simulation, Grid<std::int8_t> region,
                                 std::int64_t points_per_batch, const ProgressCallback& progress = {});

/// How a whole number that belongs to each bin is spread over the region.
struct BinSpread {
  double mean = 0;
  std::int64_t min = 0;
  std::int64_t p05 = 0;  ///< the least value that at least 5 % of the bins do not exceed
  std::int64_t median = 0;
  std::int64_t p95 = 0;
  std::int64_t max = 0;
  double above_one_frac = 0;  ///< bins with 2 or more
};

/// The region must have a bin and the values be >= 0.
[[nodiscard]] BinSpread spread_over_region(const Grid<std::int32_t>& values, const Grid<std::int8_t>& region);

}  // namespace landfall
