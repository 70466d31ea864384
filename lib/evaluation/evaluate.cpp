// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/evaluate.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "evaluation/accuracy.h"
#include "evaluation/coverage.h"
#include "evaluation/distance_transform.h"

namespace landfall {
namespace {

void check_layer(const char* name, const Grid<double>& layer, const GridSpec& spec) {
  if (layer.spec() != spec) throw FormatError(std::string(name) + ": its grid differs from that of z_est");
  const auto found = std::ranges::find_if(layer.values(), [](double v) { return std::isinf(v); });
  if (found == layer.values().end()) return;
  const std::int64_t index = found - layer.values().begin();
  throw FormatError(std::string(name) + ": the value in row " + std::to_string(index / spec.cols) +
                    ", column " + std::to_string(index % spec.cols) + " is infinite");
}

void check_layers(const DemLayers& dem) {
  const GridSpec& spec = dem.z_est.spec();
  check_layer("z_est", dem.z_est, spec);
  if (!dem.truth) return;
  check_layer("x_true", dem.truth->x, spec);
  check_layer("y_true", dem.truth->y, spec);
  check_layer("z_true", dem.truth->z, spec);
}

Grid<float> to_float(const Grid<double>& grid) {
  Grid<float> result(grid.spec());
  std::ranges::transform(grid.values(), result.values().begin(),
                         [](double v) { return static_cast<float>(v); });
  return result;
}

Grid<float> distance_layer(const Grid<std::int64_t>& squared) {
  Grid<float> result(squared.spec());
  std::ranges::transform(squared.values(), result.values().begin(),
                         [](std::int64_t d) { return static_cast<float>(distance_bins(d)); });
  return result;
}

void set_flag(std::int8_t& flags, FailFlag flag) { flags = static_cast<std::int8_t>(flags | flag); }

/// NaN, a footprint without a value, is above no limit.
void flag_above(const Grid<double>& values, double limit, FailFlag flag, Grid<std::int8_t>& fail) {
  for (std::size_t i = 0; i < fail.spec().size(); ++i)
    if (values.values()[i] > limit) set_flag(fail.values()[i], flag);
}

void flag_coverage(const Coverage& coverage, const EvaluationLimits& limits, Grid<std::int8_t>& fail) {
  for (std::size_t i = 0; i < fail.spec().size(); ++i) {
    const std::int32_t id = coverage.hole_id.values()[i];
    if (id == 0) continue;
    std::int8_t& flags = fail.values()[i];
    if (coverage.holes[static_cast<std::size_t>(id - 1)].size_bins > limits.hole_bins)
      set_flag(flags, kFailHoleSize);
    if (distance_bins(coverage.squared_distance.values()[i]) > limits.distance_bins)
      set_flag(flags, kFailDistance);
  }
}

/// Where an axis' limit, results and layers are.
struct AxisFields {
  Axis axis;
  FailFlag flag;
  double EvaluationLimits::*limit_m;
  AbsoluteMetrics AccuracyMetrics::Absolute::*absolute;
  RelativeMetrics AccuracyMetrics::Relative::*relative;
  AxisLayers AccuracyLayers::*layers;
};

constexpr AxisFields kX{Axis::x,
                        kFailRelativeX,
                        &EvaluationLimits::relative_horizontal_m,
                        &AccuracyMetrics::Absolute::x,
                        &AccuracyMetrics::Relative::x,
                        &AccuracyLayers::x};
constexpr AxisFields kY{Axis::y,
                        kFailRelativeY,
                        &EvaluationLimits::relative_horizontal_m,
                        &AccuracyMetrics::Absolute::y,
                        &AccuracyMetrics::Relative::y,
                        &AccuracyLayers::y};
constexpr AxisFields kZ{Axis::z,
                        kFailRelativeZ,
                        &EvaluationLimits::relative_elevation_m,
                        &AccuracyMetrics::Absolute::z,
                        &AccuracyMetrics::Relative::z,
                        &AccuracyLayers::z};

/// The accuracy requirements, axis after axis, so that few grids of double live at a time.
class AccuracyPass {
 public:
  AccuracyPass(const DemLayers& dem, const EvaluationParameters& parameters, const BinMask& region)
      : dem_(dem),
        limits_(parameters.limits),
        region_(region),
        shape_{footprint_half_bins(parameters.footprint_m, dem.z_est.spec().resolution_m),
               parameters.quantile} {}

  struct Output {
    AccuracyMetrics& metrics;
    AccuracyLayers* layers;  ///< null for metrics only
    Grid<std::int8_t>& fail;
  };

  /// The DEM must have truth.
  void run(const Output& out, const ProgressCallback& progress) const {
    out.metrics.footprint_bins = 2 * shape_.half_bins + 1;
    out.metrics.quantile = shape_.quantile;
    judge_axis(kZ, out, third(progress, 0));
    Grid<double> mean_x = judge_axis(kX, out, third(progress, 1));
    const Grid<double> horizontal =
        horizontal_error(std::move(mean_x), judge_axis(kY, out, third(progress, 2)));
    out.metrics.absolute.horizontal = summarise_horizontal(horizontal, limits_.absolute_horizontal_m);
    flag_above(horizontal, limits_.absolute_horizontal_m, kFailAbsoluteHorizontal, out.fail);
  }

 private:
  /// The footprints' means.
  Grid<double> judge_axis(const AxisFields& fields, const Output& out,
                          const ProgressCallback& progress) const {
    const double limit_m = limits_.*fields.limit_m;
    Grid<double> error = error_of(fields.axis, dem_, *dem_.truth);
    FootprintStatistics statistics = footprint_statistics(error, region_, shape_, progress);
    out.metrics.absolute.*fields.absolute = summarise_absolute(statistics.mean);
    out.metrics.relative.*fields.relative = summarise_relative(statistics.relative, limit_m);
    flag_above(statistics.relative, limit_m, fields.flag, out.fail);
    if (out.layers)
      out.layers->*fields.layers = {std::move(error), to_float(statistics.mean),
                                    to_float(statistics.relative)};
    return std::move(statistics.mean);
  }

  /// An axis' share of the progress; the last hundredth is left to the summary.
  static ProgressCallback third(const ProgressCallback& progress, int index) {
    if (!progress) return {};
    return [&progress, index](double fraction) { progress(0.33 * (index + fraction)); };
  }

  const DemLayers& dem_;
  const EvaluationLimits& limits_;
  const BinMask& region_;
  FootprintShape shape_;
};

}  // namespace

Evaluation evaluate(const DemLayers& dem, const EvaluationParameters& parameters, EvaluationOutput output,
                    const ProgressCallback& progress) {
  check(parameters);
  check_layers(dem);
  BinMask region = circular_region(dem.z_est.spec(), parameters.region_radius_m);
  const AccuracyPass accuracy(dem, parameters, region);
  Coverage coverage = assess_coverage(dem.z_est, region, parameters.limits);
  Grid<std::int8_t> fail(dem.z_est.spec());
  flag_coverage(coverage, parameters.limits, fail);

  Evaluation result;
  result.holes = std::move(coverage.holes);
  if (output == EvaluationOutput::layers_and_metrics) {
    result.layers.emplace();
    result.layers->invalid = std::move(coverage.invalid);
    result.layers->hole_id = std::move(coverage.hole_id);
    result.layers->distance_to_valid = distance_layer(coverage.squared_distance);
    if (dem.truth) result.layers->accuracy.emplace();
  }
  Metrics& metrics = result.metrics;
  metrics.region = {parameters.region_radius_m, count_set(region)};
  metrics.coverage = std::move(coverage.metrics);
  coverage = {};  // its grids are as large as those of an axis

  if (dem.truth) {
    AccuracyLayers* const layers = result.layers ? &*result.layers->accuracy : nullptr;
    accuracy.run({metrics.accuracy.emplace(), layers, fail}, progress);
  }
  metrics.requirements = judge(metrics.coverage, metrics.accuracy, parameters.limits);
  metrics.pass = overall_pass(metrics.requirements);
  if (result.layers) {
    result.layers->in_region = std::move(region);
    result.layers->fail = std::move(fail);
  }
  report(progress, 1);
  return result;
}

}  // namespace landfall
