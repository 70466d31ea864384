// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/plan_table.h"

#include "cli/print.h"

namespace landfall::cli {
namespace {

std::string time_line(const char* name, const PlanMetrics::Pulses& pulses) {
  return print("  %-34s %10ld %12.4f %8.2f %%\n", name, pulses.pulse_count, pulses.time_s, 100 * pulses.frac);
}

std::string spread_line(const char* name, const BinSpread& s) {
  return print("  %-20s %8.3f %8ld %8ld %8ld %8ld %8ld\n", name, s.mean, s.min, s.p05, s.median, s.p95,
               s.max);
}

}  // namespace

std::string plan_table(const PlanMetrics& plan) {
  const CoverageMetrics& coverage = plan.coverage;
  std::string text = "Time                                     pulses     seconds     share\n";
  text += time_line("frame in the region", plan.time.in_region) +
          time_line("frame partly in the region", plan.time.partly_in_region) +
          time_line("frame outside the region", plan.time.off_region) +
          time_line("blanked", plan.time.blanked) + time_line("all", plan.time.total);
  text += print("\nRegion: %ld bins of %g m within %g m, on flat ground\n", plan.region.bin_count,
                plan.region.resolution_m, plan.region.radius_m);
  text += print("  uncovered: %ld bins, %.4f %%, in %ld holes; the largest has %ld bins\n",
                coverage.invalid_count, 100 * coverage.invalid_frac, coverage.hole_count,
                coverage.largest_hole_bins);
  text += print("  returns: %ld, of which %ld in the region and %ld the first of their bin\n",
                plan.returns.count, plan.returns.in_region, plan.returns.first_in_bin);
  text +=
      print("  seen by more than one frame: %.2f %% of the bins\n", 100 * plan.frames_per_bin.above_one_frac);
  text += print("\n  %-20s %8s %8s %8s %8s %8s %8s\n", "Per bin of the region", "mean", "least", "5 %",
                "median", "95 %", "most");
  return text + spread_line("returns", plan.returns_per_bin) + spread_line("frames", plan.frames_per_bin);
}

}  // namespace landfall::cli
