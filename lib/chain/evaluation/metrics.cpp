// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D26, D28, D408
#include "chain/evaluation/metrics.h"

#include <algorithm>
#include <string_view>

namespace landfall {
namespace {

using RequirementWords = dictionary::Requirement;
static_assert(std::ranges::all_of(dictionary::kRequirements, [](const RequirementWords& words) {
  return std::ranges::any_of(dictionary::kUnits, [&](const dictionary::Unit& unit) {
    return unit.name == std::string_view(words.unit);
  });
}));

}  // namespace

Table1Verdicts::Table1Verdicts(const EvaluationLimits& limits) {
  for (const RequirementWords& words : dictionary::kRequirements)
    all.push_back(
        {{words.name, words.value, limit_of_key(limits, words.limit).value_or(0), words.at_least}, false});
}

Table1Verdicts judge(const Metrics& metrics, const EvaluationLimits& limits, bool has_positions) {
  if (!metrics.accuracy) return judge(metrics, std::nullopt, limits);
  const AccuracyMetrics::Relative& relative = metrics.accuracy->relative;
  JudgedFootprints footprints{judges_relative_errors(metrics.accuracy->footprint_bins), has_positions, ""};
  if (relative.x.max_m) footprints.axes += 'x';
  if (relative.y.max_m) footprints.axes += 'y';
  if (relative.z.max_m) footprints.axes += 'z';
  return judge(metrics, footprints, limits);
}

std::optional<bool> overall_pass(const Table1Verdicts& requirements) {
  const auto is_of_truth = [&](const RequirementWords& words) {
    const RequirementVerdict& verdict = requirements[words.name];
    return *words.footprints != '\0' && (verdict.pass || verdict.reason);
  };
  if (std::ranges::none_of(dictionary::kRequirements, is_of_truth)) return std::nullopt;  // without truth
  if (any_is(requirements, false)) return false;
  return any_is(requirements, std::nullopt) ? std::nullopt : std::optional(true);
}

std::optional<bool> with_own(std::optional<bool> pass, const RequirementVerdicts& own) {
  return all_pass(own) ? pass : std::optional(false);
}

std::vector<ResultField> metrics_fields() { return result_fields(complete<Metrics>()); }

}  // namespace landfall
