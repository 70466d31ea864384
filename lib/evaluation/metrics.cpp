// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D26, D28, D408
#include "evaluation/metrics.h"

#include <initializer_list>

namespace landfall {
namespace {

/// The violations of all axes added; empty where an axis has no footprint to judge.
std::optional<double> violations(std::initializer_list<RelativeMetrics> axes) {
  double sum = 0;
  for (const RelativeMetrics& axis : axes) {
    if (!axis.max_m) return std::nullopt;
    sum += static_cast<double>(*axis.violation_count);
  }
  return sum;
}

}  // namespace

RequirementMetrics judge(const CoverageMetrics& coverage, const std::optional<AccuracyMetrics>& accuracy,
                         const EvaluationLimits& limits) {
  if (!accuracy) return judge_values(coverage, std::nullopt, limits);
  const AccuracyMetrics::Relative& relative = accuracy->relative;
  return judge_values(
      coverage,
      AccuracyValues{judges_relative_errors(accuracy->footprint_bins), violations({relative.z}),
                     violations({relative.x, relative.y}), accuracy->absolute.horizontal.within_limit_frac},
      limits);
}

RequirementMetrics judge_values(const CoverageMetrics& coverage,
                                const std::optional<AccuracyValues>& accuracy,
                                const EvaluationLimits& limits) {
  RequirementMetrics result;
  result.coverage = {coverage.invalid_frac, limits.invalid_frac, {}};
  result.hole_size = {
      static_cast<double>(coverage.largest_hole_bins), static_cast<double>(limits.hole_bins), {}};
  result.hole_distance = {coverage.max_distance_bins, limits.distance_bins, {}};
  result.absolute_horizontal.limit = limits.absolute_horizontal_frac;
  if (accuracy) {
    result.relative_elevation.value = accuracy->relative_elevation;
    result.relative_horizontal.value = accuracy->relative_horizontal;
    result.absolute_horizontal.value = accuracy->absolute_horizontal;
  }
  if (accuracy && !accuracy->judges_relative)
    result.relative_elevation.reason = result.relative_horizontal.reason = kFootprintBins;
  for (const RequirementInfo& info : kRequirementInfo) {
    Requirement& r = result.*info.requirement;
    if (r.value)
      r.pass = info.at_least ? *r.value >= r.limit : *r.value <= r.limit;
    else if (accuracy && !r.reason)
      r.pass = false;
  }
  return result;
}

std::optional<bool> overall_pass(const RequirementMetrics& requirements) {
  const Requirement& elevation = requirements.relative_elevation;
  if (!elevation.pass && !elevation.reason) return std::nullopt;  // without truth
  const auto any = [&](std::optional<bool> pass) {
    return std::ranges::any_of(kRequirementInfo, [&](const RequirementInfo& info) {
      return (requirements.*info.requirement).pass == pass;
    });
  };
  if (any(false)) return false;
  return any(std::nullopt) ? std::nullopt : std::optional(true);
}

std::optional<bool> with_own(std::optional<bool> pass, const OwnVerdicts& own) {
  return all_pass(own) ? pass : std::optional(false);
}

std::vector<ResultField> metrics_fields() {
  Metrics all;
  all.assumptions.emplace();
  AccuracyMetrics& accuracy = all.accuracy.emplace();
  accuracy.absolute.z_corrected.emplace();
  accuracy.relative.z_corrected.emplace();
  all.statistics.z_corrected.emplace();
  all.uncertainty.emplace();
  return result_fields(all);
}

}  // namespace landfall
