// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/verdict.h"

#include <utility>

#include "evaluation/evaluate.h"

namespace landfall {
namespace {

struct FailSink : LayerSink {
  void take(const CoverageLayers& /*layers*/) override {}
  void take(Axis /*axis*/, const AxisLayers& /*layers*/) override {}
  void take(const Grid<std::int8_t>& flags) override { fail = flags; }
  Grid<std::int8_t> fail;
};

}  // namespace

Verdict decide(const DemLayers& dem, const BinMask& region, const EvaluationParameters& parameters) {
  EvaluationParameters of_mask = parameters;
  of_mask.region_shape = RegionShape::mask;
  FailSink sink;
  const Evaluation evaluation =
      evaluate({.z_est = dem.z_est, .truth = dem.truth, .region_mask = region}, of_mask, {&sink});
  const Metrics& full = evaluation.metrics;
  Verdict result;
  result.fail = std::move(sink.fail);
  result.metrics = {full.pass, full.coverage, {}, full.requirements};
  if (!full.accuracy) return result;
  DecisiveMetrics::Accuracy& accuracy = result.metrics.accuracy.emplace();
  accuracy.absolute.horizontal.within_limit_frac = full.accuracy->absolute.horizontal.within_limit_frac;
  accuracy.relative.x.violation_count = full.accuracy->relative.x.violation_count;
  accuracy.relative.y.violation_count = full.accuracy->relative.y.violation_count;
  accuracy.relative.z.violation_count = full.accuracy->relative.z.violation_count;
  return result;
}

}  // namespace landfall
