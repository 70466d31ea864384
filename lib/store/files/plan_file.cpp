// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/plan_file.h"

#include <algorithm>
#include <utility>

#include "store/files/field_json.h"
#include "store/files/grid_file.h"

namespace landfall {
namespace {

PlanMetrics::Time time_of(const PulseBudget& b, double pulse_rate_hz) {
  const std::int64_t total = b.in_region + b.partly_in_region + b.off_region + b.blanked;
  const auto of = [&](std::int64_t pulses) -> PlanMetrics::Pulses {
    const auto count = static_cast<double>(pulses);
    return {pulses, count / pulse_rate_hz, total > 0 ? count / static_cast<double>(total) : 0};
  };
  return {of(total), of(b.in_region), of(b.partly_in_region), of(b.off_region), of(b.blanked)};
}

/// The coverage by bins that have a return.
Coverage coverage_of(const ScanPlan& plan) {
  BinMask seen(plan.region().spec());
  std::ranges::transform(plan.count().values(), seen.values().begin(),
                         [](std::int32_t count) -> std::int8_t { return count == 0 ? 0 : 1; });
  return assess_coverage(seen, plan.region(), {});
}

PlanMetrics::Posting posting_of(const ScanPlan& plan, double filled_frac) {
  const double resolution_m = plan.region().spec().resolution_m;
  const double area_m2 = static_cast<double>(count_set(plan.region())) * resolution_m * resolution_m;
  PlanMetrics::Posting posting{static_cast<double>(plan.region_return_count()) / area_m2, filled_frac};
  if (const auto found = finest_posting(plan.count(), plan.region(), filled_frac)) {
    posting.posting_m = static_cast<double>(found->bins) * resolution_m;
    posting.filled_frac = found->filled_frac;
  }
  return posting;
}

PlanMetrics plan_metrics(const ScanPlan& plan, const CoverageMetrics& coverage, const PlanRequest& request,
                         double pulse_rate_hz) {
  const std::int64_t bins = count_set(plan.region());
  return {.region = {request.radius_m, plan.region().spec().resolution_m, bins},
          .time = time_of(plan.pulses(), pulse_rate_hz),
          .returns = {plan.return_count(), plan.region_return_count(), bins - coverage.invalid_count},
          .coverage = coverage,
          .returns_per_bin = spread_over_region(plan.count(), plan.region()),
          .frames_per_bin = spread_over_region(plan.frames(), plan.region()),
          .posting = posting_of(plan, request.filled_frac)};
}

}  // namespace

PlanSummary summarize_plan(const ScanPlan& plan, const PlanRequest& request, double pulse_rate_hz) {
  Coverage coverage = coverage_of(plan);
  return {plan_metrics(plan, coverage.metrics, request, pulse_rate_hz), std::move(coverage.hole_numbers)};
}

void write_plan(LandfallFileWriter& file, const ScanPlan& plan, const PlanSummary& summary) {
  GridLayerWriter layers(file, plan.region().spec(), "");
  layers.write("count", plan.count());
  layers.write("frames", plan.frames());
  layers.write("first_seen", plan.first_seen_s());
  layers.write("in_region", plan.region());
  layers.write("hole_id", summary.hole_numbers);
  h5::write_text(file.root(), {"plan_json", "the plan in numbers"}, fields_json(summary.metrics).dump(2));
  file.commit();
}

}  // namespace landfall
