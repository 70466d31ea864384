// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D43
#include "chain/evaluation/evaluate.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/core/parallel.h"
#include "base/raster/distance_transform.h"
#include "chain/evaluation/accuracy.h"
#include "chain/evaluation/assumptions.h"
#include "chain/evaluation/coverage.h"
#include "chain/evaluation/error_statistics.h"
#include "chain/evaluation/piecewise.h"
#include "chain/evaluation/sparse_coverage.h"

namespace landfall {
namespace {

Grid<float> to_float(const Grid<double>& grid) {
  auto result = Grid<float>::unset(grid.spec());
  for_each_index(grid.values().size(),
                 [&](std::size_t i) { result.values()[i] = static_cast<float>(grid.values()[i]); });
  return result;
}

Grid<float> distance_layer(const Grid<std::int64_t>& squared) {
  auto result = Grid<float>::unset(squared.spec());
  for_each_index(squared.values().size(), [&](std::size_t i) {
    result.values()[i] = static_cast<float>(bins_apart(squared.values()[i]));
  });
  return result;
}

/// NaN, the value of a footprint without valid bins, exceeds no limit.
void flag_above(const Grid<double>& values, double limit, FailFlag flag, Grid<std::int8_t>& fail) {
  for_each_index(fail.values().size(), [&](std::size_t i) {
    if (values.values()[i] > limit) set_flag(fail.values()[i], flag);
  });
}

RegionMetrics describe(const EvaluationParameters& parameters, const BinMask& region) {
  RegionMetrics result{.shape = parameters.region_shape, .bin_count = count_set(region)};
  if (parameters.region_shape == RegionShape::circle) {
    result.radius_m = parameters.region_radius_m;
    result.center_x_m = parameters.region_center_m.x;
    result.center_y_m = parameters.region_center_m.y;
  }
  if (parameters.region_shape == RegionShape::square) result.half_width_m = parameters.region_half_width_m;
  return result;
}

using Sinks = std::vector<LayerSink*>;

/// Judges the accuracy requirements axis by axis, so that few grids of double exist at a time.
class AccuracyPass {
 public:
  AccuracyPass(const EvaluationParameters& parameters, const Sinks& sinks, Evaluation& result)
      : parameters_(parameters),
        limits_(parameters.limits),
        region_(result.region),
        rule_(footprint_rule(parameters, result.region.spec().resolution_m)),
        sinks_(sinks),
        metrics_(result.metrics.accuracy.emplace()),
        statistics_(result.metrics.statistics),
        fail_(result.fail) {}

  void run(ErrorLayers errors, const ProgressCallback& progress) const {
    metrics_.footprint_bins = rule_.footprint.edge_bins();
    metrics_.quantile = parameters_.quantile;
    const double share = 0.99 / (errors.corrected ? 4 : 3);  // the last hundredth is for the summary
    if (errors.corrected) measure_corrected(*errors.corrected, part(progress, 0, share));
    errors.corrected.reset();
    statistics_.z = error_statistics(errors.z, region_);
    AccuracyMetrics::Absolute& absolute = metrics_.absolute;
    AccuracyMetrics::Relative& relative = metrics_.relative;
    judge_axis({Axis::z, fail_relative_z, limits_.relative_z_m, absolute.z, relative.z}, std::move(errors.z),
               part(progress, 0.99 - 3 * share, share));
    if (errors.x.spec().size() == 0) return;
    AxisResult x = judge_axis({Axis::x, fail_relative_x, limits_.relative_xy_m, absolute.x, relative.x},
                              std::move(errors.x), part(progress, 0.99 - 2 * share, share));
    const AxisResult y = judge_axis({Axis::y, fail_relative_y, limits_.relative_xy_m, absolute.y, relative.y},
                                    std::move(errors.y), part(progress, 0.99 - share, share));
    judge_horizontal(horizontal_error(std::move(x.mean), y.mean));
    statistics_.horizontal = horizontal_statistics(horizontal_error(std::move(x.error), y.error), region_);
  }

 private:
  struct AxisJudgement {
    Axis axis;
    FailFlag flag;
    double limit_m;
    AbsoluteMetrics& absolute;
    RelativeMetrics& relative;
  };
  struct AxisResult {
    Grid<double> error;
    Grid<double> mean;  ///< of the footprints
  };

  AxisResult judge_axis(const AxisJudgement& judged, Grid<double> error,
                        const ProgressCallback& progress) const {
    FootprintStatistics statistics = footprint_statistics(error, region_, rule_, progress);
    judged.absolute = summarise_absolute(statistics.mean);
    judged.relative = summary_of_relative(statistics.relative, judged.limit_m);
    flag_above(statistics.relative, judged.limit_m, judged.flag, fail_);
    if (sinks_.empty()) return {std::move(error), std::move(statistics.mean)};
    AxisLayers layers{std::move(error), to_float(statistics.mean), to_float(statistics.relative)};
    for (LayerSink* const sink : sinks_) sink->take(judged.axis, layers);
    return {std::move(layers.error), std::move(statistics.mean)};
  }

  void judge_horizontal(const Grid<double>& horizontal) const {
    metrics_.absolute.horizontal = summarise_horizontal(horizontal, limits_.horizontal_m);
    flag_above(horizontal, limits_.horizontal_m, fail_absolute_horizontal, fail_);
  }

  void measure_corrected(const Grid<double>& error, const ProgressCallback& progress) const {
    statistics_.z_corrected = error_statistics(error, region_);
    const FootprintStatistics statistics = footprint_statistics(error, region_, rule_, progress);
    metrics_.absolute.z_corrected = summarise_absolute(statistics.mean);
    metrics_.relative.z_corrected = summary_of_relative(statistics.relative, limits_.relative_z_m);
  }

  [[nodiscard]] RelativeMetrics summary_of_relative(const Grid<double>& relative, double limit_m) const {
    return rule_.quantile ? summarise_relative(relative, limit_m) : RelativeMetrics{};
  }

  static ProgressCallback part(const ProgressCallback& progress, double begin, double share) {
    if (!progress) return {};
    return [&progress, begin, share](double fraction) { progress(begin + share * fraction); };
  }

  const EvaluationParameters& parameters_;
  const EvaluationLimits& limits_;
  const BinMask& region_;
  FootprintRule rule_;
  const Sinks& sinks_;
  AccuracyMetrics& metrics_;
  StatisticsMetrics& statistics_;
  Grid<std::int8_t>& fail_;
};

void record(CoverageMetrics metrics, std::vector<Hole> holes, Evaluation& result) {
  result.holes = std::move(holes);
  result.metrics.coverage = std::move(metrics);
  result.metrics.statistics.valid_frac = result.metrics.coverage.valid_frac();
}

/// Records the coverage and passes its layers to the sinks.
void pass_on(Coverage coverage, const EvaluationLimits& limits, const Sinks& sinks, Evaluation& result) {
  flag_coverage(coverage, limits, result.fail);
  record(std::move(coverage.metrics), std::move(coverage.holes), result);
  CoverageLayers layers{std::move(result.region), std::move(coverage.invalid),
                        std::move(coverage.hole_numbers), distance_layer(coverage.squared_distance)};
  coverage.squared_distance = {};
  for (LayerSink* const sink : sinks) sink->take(layers);
  result.region = std::move(layers.in_region);
}

}  // namespace

Evaluation evaluate(DemLayers dem, const EvaluationParameters& parameters, const Sinks& sinks,
                    const ProgressCallback& progress) {
  check(parameters);
  check_layers(dem);
  BinMask region = judged_region(parameters, dem.z_est.spec(), dem.region_mask ? &*dem.region_mask : nullptr);
  Evaluation result{{}, {}, std::move(region), {}};
  result.fail = Grid<std::int8_t>(dem.z_est.spec());
  Metrics& metrics = result.metrics;
  metrics.region = describe(parameters, result.region);
  metrics.assumptions =
      assumptions_of(dem, result.region, footprint_of(parameters, dem.z_est.spec().resolution_m));
  dem.count.reset();
  const bool has_positions = dem.truth && dem.truth->has_positions();
  std::optional<AccuracyPass> accuracy;
  if (dem.truth) accuracy.emplace(parameters, sinks, result);
  std::optional<Coverage> coverage;  // only with a sink: its layers cost time and memory
  JudgedCoverage judged;
  ErrorLayers errors;
  run_both(
      [&] {
        const BinMask valid = valid_bins(dem.z_est);
        if (sinks.empty())
          judged = judge_coverage(valid, result.region, parameters.limits, result.fail);
        else
          coverage = assess_coverage(valid, result.region, parameters.limits);
      },
      [&] {
        if (!accuracy) return;
        errors = errors_of(std::move(*dem.truth), dem.z_est, std::move(dem.corrected));
        if (!has_positions) return;
        metrics.statistics.x = error_statistics(errors.x, result.region);
        metrics.statistics.y = error_statistics(errors.y, result.region);
      });
  dem = {};
  if (coverage)
    pass_on(std::move(*coverage), parameters.limits, sinks, result);
  else
    record(std::move(judged.metrics), std::move(judged.holes), result);
  if (accuracy) accuracy->run(std::move(errors), progress);
  for (LayerSink* const sink : sinks) sink->take(result.fail);
  metrics.requirements = judge(metrics, parameters.limits, has_positions);
  judge_own_requirements(metrics, parameters.own_requirements);
  report(progress, 1);
  return result;
}

}  // namespace landfall
