// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/plan_file.h"

#include <cmath>
#include <limits>
#include <utility>

#include "files/grid_file.h"

namespace landfall {
namespace {

using Json = nlohmann::ordered_json;

Json pulses_json(std::int64_t pulses, std::int64_t total, double pulse_rate_hz) {
  return {{"pulse_count", pulses},
          {"time_s", static_cast<double>(pulses) / pulse_rate_hz},
          {"frac", total > 0 ? static_cast<double>(pulses) / static_cast<double>(total) : 0}};
}

Json time_json(const PulseBudget& b, double pulse_rate_hz) {
  const std::int64_t total = b.in_region + b.partly_in_region + b.off_region + b.blanked;
  return {{"total", pulses_json(total, total, pulse_rate_hz)},
          {"in_region", pulses_json(b.in_region, total, pulse_rate_hz)},
          {"partly_in_region", pulses_json(b.partly_in_region, total, pulse_rate_hz)},
          {"off_region", pulses_json(b.off_region, total, pulse_rate_hz)},
          {"blanked", pulses_json(b.blanked, total, pulse_rate_hz)}};
}

Json coverage_json(const CoverageMetrics& m) {
  return {
      {"uncovered_count", m.invalid_count},
      {"uncovered_frac", m.invalid_frac},
      {"hole_count", m.hole_count},
      {"largest_hole_bins", m.largest_hole_bins},
      {"max_distance_bins", std::isfinite(m.max_distance_bins) ? Json(m.max_distance_bins) : Json(nullptr)}};
}

Json spread_json(const BinSpread& s) {
  return {{"mean", s.mean},     {"min", s.min}, {"p05", s.p05},
          {"median", s.median}, {"p95", s.p95}, {"max", s.max}};
}

/// Of the bins that have a return.
Coverage coverage_of(const ScanPlan& plan) {
  Grid<double> z_est(plan.region().spec());
  for (std::size_t i = 0; i < z_est.values().size(); ++i)
    if (plan.count().values()[i] == 0) z_est.values()[i] = std::numeric_limits<double>::quiet_NaN();
  return assess_coverage(z_est, plan.region(), {});
}

Json plan_json(const ScanPlan& plan, const CoverageMetrics& coverage, double radius_m, double pulse_rate_hz) {
  const std::int64_t bins = count_set(plan.region());
  const BinSpread images = spread_over_region(plan.images(), plan.region());
  Json images_json = spread_json(images);
  images_json["overlap_frac"] = images.above_one_frac;
  return {
      {"region",
       {{"radius_m", radius_m}, {"resolution_m", plan.region().spec().resolution_m}, {"bin_count", bins}}},
      {"time", time_json(plan.pulses(), pulse_rate_hz)},
      {"returns",
       {{"count", plan.return_count()},
        {"in_region", plan.region_return_count()},
        {"first_in_bin", bins - coverage.invalid_count}}},
      {"coverage", coverage_json(coverage)},
      {"returns_per_bin", spread_json(spread_over_region(plan.count(), plan.region()))},
      {"images_per_bin", images_json}};
}

}  // namespace

PlanSummary summarize_plan(const ScanPlan& plan, double radius_m, double pulse_rate_hz) {
  Coverage coverage = coverage_of(plan);
  return {plan_json(plan, coverage.metrics, radius_m, pulse_rate_hz), std::move(coverage.hole_id)};
}

void write_plan(LandfallFileWriter& file, const ScanPlan& plan, const PlanSummary& summary) {
  GridLayerWriter layers(file, plan.region().spec(), "");
  layers.write("count", plan.count(), {"1", "returns in the bin"});
  layers.write("images", plan.images(), {"1", "pulses with a return in the bin"});
  layers.write("first_seen", plan.first_seen_s(), {"s", "time of the first return"});
  layers.write("in_region", plan.region(), {"1", "bins that the scan is for", {0, 1}, "outside inside"});
  layers.write("hole_id", summary.hole_id, {"1", "hole of uncovered bins in the region, 0 outside holes"});
  h5::write_text(file.root(), {"plan_json", "the plan in numbers"}, summary.numbers.dump(2));
  file.commit();
}

}  // namespace landfall
