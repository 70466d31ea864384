// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/metrics.h"

#include <algorithm>
#include <array>
#include <initializer_list>

namespace landfall {
namespace {

Requirement at_most(double value, double limit) { return {value, limit, value <= limit}; }

/// Violations of all axes added; an axis without a footprint to judge misses the requirement.
Requirement no_violation(std::initializer_list<RelativeMetrics> axes) {
  std::int64_t violations = 0;
  for (const RelativeMetrics& axis : axes) {
    if (!axis.max_m) return {std::nullopt, 0, false};
    violations += axis.violation_count;
  }
  return at_most(static_cast<double>(violations), 0);
}

Requirement share_within(const HorizontalMetrics& horizontal, double limit) {
  if (!horizontal.within_limit_frac) return {std::nullopt, limit, false};
  return {horizontal.within_limit_frac, limit, *horizontal.within_limit_frac >= limit};
}

}  // namespace

RequirementMetrics judge(const CoverageMetrics& coverage, const std::optional<AccuracyMetrics>& accuracy,
                         const EvaluationLimits& limits) {
  RequirementMetrics result;
  result.coverage = at_most(coverage.invalid_frac, limits.invalid_frac);
  result.hole_size =
      at_most(static_cast<double>(coverage.largest_hole_bins), static_cast<double>(limits.hole_bins));
  result.hole_distance = at_most(coverage.max_distance_bins, limits.distance_bins);
  result.absolute_horizontal.limit = limits.absolute_horizontal_frac;
  if (!accuracy) return result;
  const AccuracyMetrics::Relative& relative = accuracy->relative;
  result.relative_elevation = no_violation({relative.z});
  result.relative_horizontal = no_violation({relative.x, relative.y});
  result.absolute_horizontal = share_within(accuracy->absolute.horizontal, limits.absolute_horizontal_frac);
  return result;
}

std::optional<bool> overall_pass(const RequirementMetrics& requirements) {
  const std::array passes{requirements.coverage.pass,
                          requirements.hole_size.pass,
                          requirements.hole_distance.pass,
                          requirements.relative_elevation.pass,
                          requirements.relative_horizontal.pass,
                          requirements.absolute_horizontal.pass};
  if (std::ranges::any_of(passes, [](const auto& pass) { return !pass.has_value(); })) return std::nullopt;
  return std::ranges::all_of(passes, [](const auto& pass) { return *pass; });
}

}  // namespace landfall
