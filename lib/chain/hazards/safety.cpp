// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D280
#include "chain/hazards/safety.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace landfall {
namespace {

constexpr std::size_t kRocPoints = 21;
constexpr std::size_t kReliabilityBins = 10;

Safety judge(double slope_deg, double roughness_m, const HazardLimits& limits) {
  if (std::isnan(slope_deg) || std::isnan(roughness_m)) return Safety::unknown;
  return slope_deg <= limits.slope_deg && roughness_m <= limits.roughness_m ? Safety::safe : Safety::hazard;
}

HazardOutcome outcome_of(Safety judged, Safety truth) {
  if (judged == Safety::unknown || truth == Safety::unknown) return HazardOutcome::unknown;
  if (judged == Safety::safe)
    return truth == Safety::safe ? HazardOutcome::safe_found : HazardOutcome::missed_hazard;
  return truth == Safety::safe ? HazardOutcome::false_alarm : HazardOutcome::hazard_found;
}

std::optional<double> fraction(std::int64_t part, std::int64_t whole) {
  if (whole == 0) return {};
  return static_cast<double>(part) / static_cast<double>(whole);
}

HazardScore::Rates rates_of(const HazardScore::Counts& counts) {
  return {fraction(counts.safe_hazard, counts.safe_hazard + counts.hazard_hazard),
          fraction(counts.hazard_safe, counts.hazard_safe + counts.safe_safe)};
}

void count(HazardScore::Counts& counts, HazardOutcome outcome) {
  switch (outcome) {
    case HazardOutcome::hazard_found:
      ++counts.hazard_hazard;
      break;
    case HazardOutcome::safe_found:
      ++counts.safe_safe;
      break;
    case HazardOutcome::missed_hazard:
      ++counts.safe_hazard;
      break;
    case HazardOutcome::false_alarm:
      ++counts.hazard_safe;
      break;
    case HazardOutcome::unknown:
      ++counts.unknown;
      break;
  }
}

std::vector<HazardScore::RocPoint> roc_of(const PlaceMeasures& judged, const Grid<std::int8_t>& truth,
                                          const HazardLimits& limits, const BinMask& region) {
  std::vector<HazardScore::RocPoint> roc;
  for (std::size_t i = 0; i < kRocPoints; ++i) {
    HazardLimits tried = limits;
    tried.roughness_m = 2 * limits.roughness_m * static_cast<double>(i) / (kRocPoints - 1);
    HazardScore::Counts counts;
    for (std::size_t k = 0; k < region.spec().size(); ++k)
      if (region.values()[k] != 0)
        count(counts, outcome_of(judge(judged.slope_deg.values()[k], judged.roughness_m.values()[k], tried),
                                 static_cast<Safety>(truth.values()[k])));
    roc.push_back({tried.roughness_m, rates_of(counts)});
  }
  return roc;
}

/// Compares the places that are known in the map and in the truth.
void compare_probabilities(const Grid<float>& p_safe, const Grid<std::int8_t>& judged,
                           const Grid<std::int8_t>& truth, const BinMask& region, HazardScore& score) {
  std::array<std::int64_t, kReliabilityBins> counts{};
  std::array<std::int64_t, kReliabilityBins> safe{};
  double square = 0;
  std::int64_t total = 0;
  for (std::size_t k = 0; k < region.spec().size(); ++k) {
    const double p = p_safe.values()[k];
    const auto is_true = static_cast<Safety>(truth.values()[k]);
    if (region.values()[k] == 0 || std::isnan(p) || is_true == Safety::unknown ||
        static_cast<Safety>(judged.values()[k]) == Safety::unknown)
      continue;
    const auto bin = std::min(static_cast<std::size_t>(p * kReliabilityBins), kReliabilityBins - 1);
    ++counts[bin];
    safe[bin] += is_true == Safety::safe ? 1 : 0;
    const double off = p - (is_true == Safety::safe ? 1 : 0);
    square += off * off;
    ++total;
  }
  if (total > 0) score.brier = square / static_cast<double>(total);
  for (std::size_t i = 0; i < kReliabilityBins; ++i)
    score.reliability.push_back({static_cast<double>(i) / kReliabilityBins,
                                 static_cast<double>(i + 1) / kReliabilityBins, counts[i],
                                 fraction(safe[i], counts[i])});
}

}  // namespace

Grid<std::int8_t> judge_places(const PlaceMeasures& measures, const HazardLimits& limits) {
  auto safe = Grid<std::int8_t>::unset(measures.slope_deg.spec());
  for (std::size_t i = 0; i < safe.spec().size(); ++i)
    safe.values()[i] = static_cast<std::int8_t>(
        judge(measures.slope_deg.values()[i], measures.roughness_m.values()[i], limits));
  return safe;
}

Grid<std::int8_t> outcomes(const Grid<std::int8_t>& judged, const Grid<std::int8_t>& truth) {
  assert(judged.spec() == truth.spec());
  auto result = Grid<std::int8_t>::unset(judged.spec());
  for (std::size_t i = 0; i < result.spec().size(); ++i)
    result.values()[i] = static_cast<std::int8_t>(
        outcome_of(static_cast<Safety>(judged.values()[i]), static_cast<Safety>(truth.values()[i])));
  return result;
}

HazardScore score_hazards(const PlaceMeasures& judged, const PlaceMeasures& truth, const HazardLimits& limits,
                          const BinMask& region, const Grid<float>* p_safe) {
  HazardScore score;
  const Grid<std::int8_t> safe = judge_places(judged, limits);
  const Grid<std::int8_t> true_safe = judge_places(truth, limits);
  for (std::size_t k = 0; k < region.spec().size(); ++k)
    if (region.values()[k] != 0)
      count(score.counts,
            outcome_of(static_cast<Safety>(safe.values()[k]), static_cast<Safety>(true_safe.values()[k])));
  score.rates = rates_of(score.counts);
  score.roc = roc_of(judged, true_safe, limits, region);
  if (p_safe != nullptr) compare_probabilities(*p_safe, safe, true_safe, region, score);
  return score;
}

}  // namespace landfall
