// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "chain/evaluation/coverage.h"
#include "chain/lidar/simulation/scan_plan.h"
#include "store/files/landfall_file.h"

namespace landfall {

/// The numbers of a plan, as stored in /plan_json (store/files/field_json.h); docs/user/scan-sim.md describes
/// each.
struct PlanMetrics {
  struct Pulses {
    std::int64_t pulse_count = 0;
    double time_s = 0;
    double frac = 0;  ///< of all pulses
    LANDFALL_FIELDS(pulse_count, time_s, frac)
  };
  struct Time {
    Pulses total, in_region, partly_in_region, off_region, blanked;
    LANDFALL_FIELDS(total, in_region, partly_in_region, off_region, blanked)
  };
  struct Region {
    double radius_m = 0;
    double resolution_m = 0;
    std::int64_t bin_count = 0;
    LANDFALL_FIELDS(radius_m, resolution_m, bin_count)
  };
  struct Returns {
    std::int64_t count = 0;
    std::int64_t in_region = 0;
    std::int64_t first_in_bin = 0;  ///< bins with a return
    LANDFALL_FIELDS(count, in_region, first_in_bin)
  };

  /// The finest posting of a DEM that the scan supports.
  struct Posting {
    double returns_per_m2 = 0;
    double wanted_frac = 0;                            ///< of the bins that shall have a return
    std::optional<double> posting_m = std::nullopt;    ///< none if the region is too small for one
    std::optional<double> filled_frac = std::nullopt;  ///< of its bins have a return
    LANDFALL_FIELDS(returns_per_m2, wanted_frac, posting_m, filled_frac)
  };

  Region region;
  Time time;
  Returns returns;
  CoverageMetrics coverage;  ///< of the bins with a return
  BinSpread returns_per_bin;
  BinSpread frames_per_bin;
  std::optional<Posting> posting;  ///< none in files of landfall 0.2.0 and earlier

  static void fields(auto& walk, auto& m) {
    walk.all("region, time, returns", m.region, m.time, m.returns);
    walk.inside("coverage", [&] {
      walk("uncovered_count", m.coverage.invalid_count);
      walk("uncovered_frac", m.coverage.invalid_frac);
      walk.all("hole_count, largest_hole_bins, max_distance_bins", m.coverage.hole_count,
               m.coverage.largest_hole_bins, m.coverage.max_distance_bins);
    });
    walk("returns_per_bin", m.returns_per_bin);
    walk.inside("frames_per_bin", [&] {
      BinSpread::fields(walk, m.frames_per_bin);
      walk("overlap_frac", m.frames_per_bin.above_one_frac);
    });
    walk("posting", m.posting);
  }
};

/// The results of a plan for its region.
struct PlanSummary {
  PlanMetrics metrics;
  Grid<std::int32_t> hole_numbers;  ///< of the bins without a return (Coverage)
};

struct PlanRequest {
  double radius_m = 0;     ///< of the plan's region
  double filled_frac = 0;  ///< wanted share of the bins of the proposed posting
};

[[nodiscard]] PlanSummary summarize_plan(const ScanPlan& plan, const PlanRequest& request,
                                         double pulse_rate_hz);

/// Writes the layers count, frames, first_seen, in_region and the numbers of holes, and the metrics as
/// /plan_json; commits.
void write_plan(LandfallFileWriter& file, const ScanPlan& plan, const PlanSummary& summary);

}  // namespace landfall
