// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/draws/device_judge.h"

#include <utility>
#include <vector>

namespace landfall {
namespace {

DeviceRule rule_of(const EvaluationParameters& parameters, const Footprint& footprint, TruthAt truth_at) {
  const EvaluationLimits limits = effective_limits(parameters, footprint);
  return {.quantile = parameters.quantile,
          .relative_m = limits.relative_m(),
          .horizontal_m = limits.horizontal_m,
          .half_bins = footprint.half_bins(),
          .is_square = footprint.is_square() ? 1 : 0,
          .at_centroid = truth_at == TruthAt::centroid ? 1 : 0,
          .has_maps = 0};
}

std::vector<std::int64_t> half_widths_of(const Footprint& footprint) {
  std::vector<std::int64_t> widths;
  for (std::int64_t offset = 0; offset <= footprint.half_bins(); ++offset)
    widths.push_back(footprint.half_width(offset));
  return widths;
}

TileVerdict footprints_of(const DeviceVerdict& verdict) {
  const auto& [x, y, z, absolute, in_x, in_y, in_z, in_both] = verdict.counts;
  TileVerdict footprints;
  footprints.x = {.footprints = in_x, .violations = x};
  footprints.y = {.footprints = in_y, .violations = y};
  footprints.z = {.footprints = in_z, .violations = z};
  footprints.horizontal = {.footprints = in_both, .violations = absolute};
  return footprints;
}

}  // namespace

DeviceJudge::DeviceJudge(DeviceGridder& gridder, const TriangulatedGrid& terrain, const BinMask& region,
                         const Grid<double>* map_truth)
    : gridder_(gridder),
      terrain_(terrain),
      region_(region),
      map_truth_(map_truth),
      valid_(BinMask::unset(region.spec())) {}

std::optional<DecisiveMetrics> DeviceJudge::judge(const Simulation& simulation, Method method,
                                                  TruthAt truth_at, const EvaluationParameters& parameters) {
  check(parameters);
  const Footprint footprint = footprint_of(parameters, region_.spec().resolution_m);
  if (footprint.half_bins() > kMaxHalfBins) return std::nullopt;
  DeviceVerdict verdict{.counts = {}, .valid = valid_.values()};
  const bool is_judged = gridder_.make(simulation, method, [&](DeviceDraws& draws) {
    if (!std::exchange(is_prepared_, true)) draws.prepare_verdicts(judged());
    return draws.judge(rule_of(parameters, footprint, truth_at), half_widths_of(footprint), verdict);
  });
  if (!is_judged) return std::nullopt;
  Grid<std::int8_t> fail(region_.spec());  // the device has added its flags to the maps
  return decisive_metrics(footprints_of(verdict), valid_, region_, parameters, fail);
}

DeviceJudged DeviceJudge::judged() const {
  const GridSpec& nodes = terrain_.nodes().spec();
  return {.surface = {.resolution_m = nodes.resolution_m,
                      .anchor = terrain_.origin().anchor(),
                      .first_row = static_cast<double>(nodes.first_row),
                      .first_col = static_cast<double>(nodes.first_col),
                      .rows = nodes.rows,
                      .cols = nodes.cols},
          .nodes = terrain_.nodes().values(),
          .region = region_.values(),
          .map_truth = map_truth_ == nullptr ? std::span<const double>() : map_truth_->values()};
}

bool DeviceJudge::take_maps(std::int64_t draws, DrawMaps& maps) {
  DrawMaps part(maps.spec());
  part.draws = draws;
  const DeviceSums sums{.counts = {part.invalid.values(), part.failing[0].values(), part.failing[1].values(),
                                   part.failing[2].values(), part.failing[3].values(),
                                   part.e_z.count.values(), part.e_map->count.values()},
                        .sums = {part.count.values(), part.e_z.sum.values(), part.e_map->sum.values()},
                        .squares = {part.e_z.squares.values(), part.e_map->squares.values()}};
  if (!gridder_.attempt([&](DeviceDraws& device) { device.take_sums(sums); })) return false;
  maps.merge(part);
  return true;
}

}  // namespace landfall
