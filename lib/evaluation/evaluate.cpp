// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/evaluate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "evaluation/accuracy.h"
#include "evaluation/coverage.h"
#include "evaluation/distance_transform.h"
#include "evaluation/error_statistics.h"
#include "evaluation/piecewise.h"

namespace landfall {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

void check_layer(const char* name, const Grid<double>& layer, const GridSpec& spec) {
  if (layer.spec() != spec) throw FormatError(std::string(name) + ": its grid differs from that of z_est");
  const auto first_infinite = [&](std::size_t begin, std::size_t end) {
    const auto values = layer.values().subspan(begin, end - begin);
    const auto found = std::ranges::find_if(values, [](double v) { return std::isinf(v); });
    return found == values.end() ? kNone : begin + static_cast<std::size_t>(found - values.begin());
  };
  const std::vector<std::size_t> pieces = by_piece(spec.size(), first_infinite);
  const std::size_t index = *std::ranges::min_element(pieces);
  if (index == kNone) return;
  const auto cols = static_cast<std::size_t>(spec.cols);
  throw FormatError(std::string(name) + ": the value in row " + std::to_string(index / cols) + ", column " +
                    std::to_string(index % cols) + " is infinite");
}

void check_layers(const DemLayers& dem) {
  const GridSpec& spec = dem.z_est.spec();
  check_layer("z_est", dem.z_est, spec);
  if (dem.z_corrected) check_layer("z_corrected", *dem.z_corrected, spec);
  if (!dem.truth) return;
  check_layer("x_true", dem.truth->x, spec);
  check_layer("y_true", dem.truth->y, spec);
  check_layer("z_true", dem.truth->z, spec);
}

Grid<float> to_float(const Grid<double>& grid) {
  auto result = Grid<float>::unset(grid.spec());
  for_each_index(grid.values().size(),
                 [&](std::size_t i) { result.values()[i] = static_cast<float>(grid.values()[i]); });
  return result;
}

Grid<float> distance_layer(const Grid<std::int64_t>& squared) {
  auto result = Grid<float>::unset(squared.spec());
  for_each_index(squared.values().size(), [&](std::size_t i) {
    result.values()[i] = static_cast<float>(distance_bins(squared.values()[i]));
  });
  return result;
}

void set_flag(std::int8_t& flags, FailFlag flag) { flags = static_cast<std::int8_t>(flags | flag); }

/// NaN, a footprint without a value, is above no limit.
void flag_above(const Grid<double>& values, double limit, FailFlag flag, Grid<std::int8_t>& fail) {
  for_each_index(fail.values().size(), [&](std::size_t i) {
    if (values.values()[i] > limit) set_flag(fail.values()[i], flag);
  });
}

void flag_coverage(const Coverage& coverage, const EvaluationLimits& limits, Grid<std::int8_t>& fail) {
  for (std::size_t i = 0; i < fail.spec().size(); ++i) {
    const std::int32_t id = coverage.hole_id.values()[i];
    if (id == 0) continue;
    std::int8_t& flags = fail.values()[i];
    if (coverage.holes[static_cast<std::size_t>(id - 1)].size_bins > limits.hole_bins)
      set_flag(flags, fail_hole_size);
    if (distance_bins(coverage.squared_distance.values()[i]) > limits.distance_bins)
      set_flag(flags, fail_distance);
  }
}

RegionMetrics describe(const EvaluationParameters& parameters, const BinMask& region) {
  RegionMetrics result{.shape = parameters.region_shape, .bin_count = count_set(region)};
  if (parameters.region_shape == RegionShape::circle) result.radius_m = parameters.region_radius_m;
  if (parameters.region_shape == RegionShape::square) result.half_width_m = parameters.region_half_width_m;
  return result;
}

/// Where an axis' truth, limit and results are.
struct AxisFields {
  Axis axis;
  FailFlag flag;
  Grid<double> TrueLayers::*truth;
  double EvaluationLimits::*limit_m;
  AbsoluteMetrics AccuracyMetrics::Absolute::*absolute;
  RelativeMetrics AccuracyMetrics::Relative::*relative;
  ErrorStatistics StatisticsMetrics::*statistics;
};

constexpr AxisFields kX{Axis::x,
                        fail_relative_x,
                        &TrueLayers::x,
                        &EvaluationLimits::relative_horizontal_m,
                        &AccuracyMetrics::Absolute::x,
                        &AccuracyMetrics::Relative::x,
                        &StatisticsMetrics::x};
constexpr AxisFields kY{Axis::y,
                        fail_relative_y,
                        &TrueLayers::y,
                        &EvaluationLimits::relative_horizontal_m,
                        &AccuracyMetrics::Absolute::y,
                        &AccuracyMetrics::Relative::y,
                        &StatisticsMetrics::y};
constexpr AxisFields kZ{Axis::z,
                        fail_relative_z,
                        &TrueLayers::z,
                        &EvaluationLimits::relative_elevation_m,
                        &AccuracyMetrics::Absolute::z,
                        &AccuracyMetrics::Relative::z,
                        &StatisticsMetrics::z};

/// The accuracy requirements, axis after axis, so that few grids of double live at a time.
class AccuracyPass {
 public:
  struct Output {
    AccuracyMetrics& metrics;
    StatisticsMetrics& statistics;
    LayerSink* sink;  ///< may be null
    Grid<std::int8_t>& fail;
  };

  AccuracyPass(const EvaluationParameters& parameters, const BinMask& region, const Output& out)
      : limits_(parameters.limits),
        region_(region),
        rule_{footprint_of(parameters, region.spec().resolution_m), parameters.quantile},
        out_(out) {}

  /// Errors and their statistics, of x and y: they take the place of their truth. To be called before run().
  void measure_horizontal_errors(DemLayers& dem) const {
    measure_errors(kX, dem);
    measure_errors(kY, dem);
  }

  /// The DEM must have truth, which is used up.
  void run(DemLayers& dem, const ProgressCallback& progress) const {
    out_.metrics.footprint_bins = 2 * rule_.footprint.half_bins() + 1;
    out_.metrics.quantile = rule_.quantile;
    const double share = 0.99 / (dem.z_corrected ? 4 : 3);  // the last hundredth is left to the summary
    if (dem.z_corrected) measure_corrected(dem, part(progress, 0, share));
    measure_errors(kZ, dem);
    judge_axis(kZ, dem, part(progress, 0.99 - 3 * share, share));
    AxisResult x = judge_axis(kX, dem, part(progress, 0.99 - 2 * share, share));
    const AxisResult y = judge_axis(kY, dem, part(progress, 0.99 - share, share));
    judge_horizontal(horizontal_error(std::move(x.mean), y.mean));
    out_.statistics.horizontal =
        horizontal_statistics(horizontal_error(std::move(x.error), y.error), region_);
  }

 private:
  struct AxisResult {
    Grid<double> error;
    Grid<double> mean;  ///< of the footprints
  };

  void measure_errors(const AxisFields& fields, DemLayers& dem) const {
    Grid<double>& layer = (*dem.truth).*fields.truth;
    layer = error_of(fields.axis, std::move(layer), dem.z_est);
    out_.statistics.*fields.statistics = error_statistics(layer, region_);
  }

  AxisResult judge_axis(const AxisFields& fields, DemLayers& dem, const ProgressCallback& progress) const {
    const double limit_m = limits_.*fields.limit_m;
    AxisLayers layers;
    layers.error = std::move((*dem.truth).*fields.truth);
    FootprintStatistics statistics = footprint_statistics(layers.error, region_, rule_, progress);
    out_.metrics.absolute.*fields.absolute = summarise_absolute(statistics.mean);
    out_.metrics.relative.*fields.relative = summarise_relative(statistics.relative, limit_m);
    flag_above(statistics.relative, limit_m, fields.flag, out_.fail);
    if (out_.sink != nullptr) {
      layers.absolute = to_float(statistics.mean);
      layers.relative = to_float(statistics.relative);
      out_.sink->take(fields.axis, layers);
    }
    return {std::move(layers.error), std::move(statistics.mean)};
  }

  void judge_horizontal(const Grid<double>& horizontal) const {
    out_.metrics.absolute.horizontal = summarise_horizontal(horizontal, limits_.absolute_horizontal_m);
    flag_above(horizontal, limits_.absolute_horizontal_m, fail_absolute_horizontal, out_.fail);
  }

  /// The corrected elevation, which is used up.
  void measure_corrected(DemLayers& dem, const ProgressCallback& progress) const {
    const Grid<double> error = error_of(Axis::z, dem.truth->z, *dem.z_corrected);
    dem.z_corrected.reset();
    out_.statistics.z_corrected = error_statistics(error, region_);
    const FootprintStatistics statistics = footprint_statistics(error, region_, rule_, progress);
    out_.metrics.absolute.z_corrected = summarise_absolute(statistics.mean);
    out_.metrics.relative.z_corrected = summarise_relative(statistics.relative, limits_.relative_elevation_m);
  }

  static ProgressCallback part(const ProgressCallback& progress, double begin, double share) {
    if (!progress) return {};
    return [&progress, begin, share](double fraction) { progress(begin + share * fraction); };
  }

  const EvaluationLimits& limits_;
  const BinMask& region_;
  FootprintRule rule_;
  Output out_;
};

/// Takes over what is known of the coverage and gives its layers to the sink. The region comes back.
BinMask take_coverage(Coverage coverage, BinMask region, const EvaluationLimits& limits, LayerSink* sink,
                      Evaluation& result, Grid<std::int8_t>& fail) {
  flag_coverage(coverage, limits, fail);
  result.holes = std::move(coverage.holes);
  result.metrics.coverage = std::move(coverage.metrics);
  result.metrics.statistics.valid_frac = 1 - result.metrics.coverage.invalid_frac;
  if (sink == nullptr) return region;
  CoverageLayers layers{std::move(region), std::move(coverage.invalid), std::move(coverage.hole_id),
                        distance_layer(coverage.squared_distance)};
  coverage.squared_distance = {};
  sink->take(layers);
  return std::move(layers.in_region);
}

}  // namespace

BinMask judged_region(const DemLayers& dem, const EvaluationParameters& parameters) {
  const GridSpec& spec = dem.z_est.spec();
  if (parameters.region_shape == RegionShape::circle)
    return circular_region(spec, parameters.region_radius_m);
  if (parameters.region_shape == RegionShape::square)
    return square_region(spec, parameters.region_half_width_m);
  if (!dem.region_mask || dem.region_mask->spec() != spec)
    throw FormatError("region/path: its grid differs from that of z_est");
  if (count_set(*dem.region_mask) == 0) throw FormatError("region/path: the mask has no bin set");
  return *dem.region_mask;
}

Evaluation evaluate(DemLayers dem, const EvaluationParameters& parameters, LayerSink* sink,
                    const ProgressCallback& progress) {
  check(parameters);
  check_layers(dem);
  Evaluation result;
  Metrics& metrics = result.metrics;
  Grid<std::int8_t> fail(dem.z_est.spec());
  BinMask region = judged_region(dem, parameters);
  metrics.region = describe(parameters, region);
  std::optional<AccuracyPass> accuracy;
  if (dem.truth)
    accuracy.emplace(parameters, region,
                     AccuracyPass::Output{metrics.accuracy.emplace(), metrics.statistics, sink, fail});
  Coverage coverage;
  run_both([&] { coverage = assess_coverage(dem.z_est, region, parameters.limits); },
           [&] {
             if (accuracy) accuracy->measure_horizontal_errors(dem);
           });
  region = take_coverage(std::move(coverage), std::move(region), parameters.limits, sink, result, fail);
  if (accuracy) accuracy->run(dem, progress);
  if (sink != nullptr) sink->take(fail);
  metrics.requirements = judge(metrics.coverage, metrics.accuracy, parameters.limits);
  metrics.pass = overall_pass(metrics.requirements);
  report(progress, 1);
  return result;
}

}  // namespace landfall
