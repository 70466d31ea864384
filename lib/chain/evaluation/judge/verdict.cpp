// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/judge/verdict.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/core/parallel.h"
#include "chain/evaluation/evaluate.h"
#include "chain/evaluation/sparse_coverage.h"

namespace landfall {
namespace {

/// The verdict of evaluate(), for data or parameters that the counts do not allow.
Verdict decide_by_evaluation(const DemLayers& dem, const BinMask& region,
                             const EvaluationParameters& parameters) {
  EvaluationParameters of_mask = parameters;
  of_mask.region_shape = RegionShape::mask;
  Evaluation evaluation = evaluate({.z_est = dem.z_est, .truth = dem.truth, .region_mask = region}, of_mask);
  const Metrics& full = evaluation.metrics;
  Verdict result;
  result.fail = std::move(evaluation.fail);
  result.metrics = {full.pass, full.coverage, {}, full.requirements, full.own_requirements};
  if (!full.accuracy) return result;
  DecisiveMetrics::Accuracy& accuracy = result.metrics.accuracy.emplace();
  accuracy.absolute.horizontal.within_limit_frac = full.accuracy->absolute.horizontal.within_limit_frac;
  accuracy.relative.x.violation_count = full.accuracy->relative.x.violation_count;
  accuracy.relative.y.violation_count = full.accuracy->relative.y.violation_count;
  accuracy.relative.z.violation_count = full.accuracy->relative.z.violation_count;
  return result;
}

bool have_one_grid(const DemLayers& dem) {
  const GridSpec& spec = dem.z_est.spec();
  return !dem.truth ||
         (dem.truth->x.spec() == spec && dem.truth->y.spec() == spec && dem.truth->z.spec() == spec);
}

/// The sum over all tiles, in any order, because the counts are integers.
TileVerdict judge_tiles(const DemLayers& dem, const BinMask& region, const EvaluationParameters& parameters,
                        const Footprint& footprint, Grid<std::int8_t>& fail) {
  const GridSpec& spec = dem.z_est.spec();
  const std::int64_t edge = tile_edge(footprint);
  std::vector<TileVerdict> verdicts(static_cast<std::size_t>((spec.rows + edge - 1) / edge));
  parallel_for(verdicts.size(), 1, [&](std::size_t begin, std::size_t end) {
    TileJudge judge(dem, region, parameters, footprint, fail);
    for (std::size_t i = begin; i < end; ++i) {
      const std::int64_t row = static_cast<std::int64_t>(i) * edge;
      for (std::int64_t col = 0; col < spec.cols; col += edge)
        verdicts[i] +=
            judge.judge({row, col, std::min(edge, spec.rows - row), std::min(edge, spec.cols - col)});
    }
  });
  TileVerdict total;
  for (const TileVerdict& verdict : verdicts) total += verdict;
  return total;
}

JudgedFootprints judged_footprints(const TileVerdict& verdict, bool judges_relative) {
  JudgedFootprints judged{.judges_relative = judges_relative, .axes = ""};
  if (verdict.x.footprints > 0) judged.axes += 'x';
  if (verdict.y.footprints > 0) judged.axes += 'y';
  if (verdict.z.footprints > 0) judged.axes += 'z';
  return judged;
}

}  // namespace

std::vector<ResultField> decisive_fields() { return result_fields(complete<DecisiveMetrics>()); }

DecisiveMetrics decisive_metrics(const std::optional<TileVerdict>& footprints, const BinMask& valid,
                                 const BinMask& region, const EvaluationParameters& parameters,
                                 Grid<std::int8_t>& fail) {
  DecisiveMetrics metrics;
  std::optional<JudgedFootprints> judged;
  if (footprints) {
    const Footprint footprint = footprint_of(parameters, region.spec().resolution_m);
    judged = judged_footprints(*footprints, judges_relative_errors(footprint.edge_bins()));
    DecisiveMetrics::Accuracy& accuracy = metrics.accuracy.emplace();
    const WindowJudge::Outcome& both = footprints->horizontal;
    const auto count = static_cast<double>(both.footprints);
    if (both.footprints > 0)
      accuracy.absolute.horizontal.within_limit_frac = (count - static_cast<double>(both.violations)) / count;
    if (judged->judges_relative)
      accuracy.relative = {
          {footprints->x.violations}, {footprints->y.violations}, {footprints->z.violations}};
  }
  metrics.coverage = judge_coverage(valid, region, parameters.limits, fail).metrics;
  metrics.requirements = landfall::judge(metrics, judged, parameters.limits);
  judge_own_requirements(metrics, parameters.own_requirements);
  return metrics;
}

Verdict decide(const DemLayers& dem, const BinMask& region, const EvaluationParameters& parameters) {
  check(parameters);
  if (!dem.truth || !have_one_grid(dem)) check_layers(dem);
  const Footprint footprint = footprint_of(parameters, dem.z_est.spec().resolution_m);
  if (footprint.half_bins() > kMaxHalfBins) return decide_by_evaluation(dem, region, parameters);
  Verdict result;
  result.fail = Grid<std::int8_t>(dem.z_est.spec());
  std::optional<TileVerdict> footprints;
  if (dem.truth) {
    footprints = judge_tiles(dem, region, parameters, footprint, result.fail);
    if (footprints->has_unusual) return decide_by_evaluation(dem, region, parameters);
  }
  result.metrics = decisive_metrics(footprints, valid_bins(dem.z_est), region, parameters, result.fail);
  return result;
}

}  // namespace landfall
