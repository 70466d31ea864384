// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D156
//
// The maps of a worst footprint are read from the DEM again, ten windows, and computed again: keeping six
// layers in memory until the worst footprints are known would take 24 bytes per bin.
#include "app/report/worst_footprints.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <utility>

#include "app/report/page_parts.h"
#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"
#include "chain/evaluation/accuracy.h"
#include "chain/evaluation/fail_flag.h"

namespace landfall::html_report {
namespace {

using Chosen = std::vector<BinIndex>;

bool apart(BinIndex bin, const Chosen& chosen, std::int64_t half_bins) {
  return std::ranges::all_of(chosen, [&](BinIndex other) {
    return std::max(std::abs(bin.row - other.row), std::abs(bin.col - other.col)) > 2 * half_bins;
  });
}

/// The column of the row's largest value that is allowed; -1 if none is above `floor`.
std::int64_t best_of_row(std::span<const float> values, std::int64_t row, const Chosen& chosen,
                         std::int64_t half_bins) {
  std::int64_t best = -1;
  for (std::int64_t col = 0; col < static_cast<std::int64_t>(values.size()); ++col) {
    const float value = values[static_cast<std::size_t>(col)];
    const bool larger = best < 0 ? !std::isnan(value) : value > values[static_cast<std::size_t>(best)];
    if (larger && apart({row, col}, chosen, half_bins)) best = col;
  }
  return best;
}

/// Sets the share, its requirement and its axis.
void find_worst(WorstFootprint& f, const EvaluationLimits& limits) {
  const std::tuple<double, const char*, char> candidates[] = {
      {share_of_limit(f.relative_m[2], limits.relative_z_m), requirement_of(fail_relative_z), 'z'},
      {share_of_limit(f.relative_m[0], limits.relative_xy_m), requirement_of(fail_relative_x), 'x'},
      {share_of_limit(f.relative_m[1], limits.relative_xy_m), requirement_of(fail_relative_y), 'y'},
      {share_of_limit(f.horizontal_m, limits.horizontal_m), requirement_of(fail_absolute_horizontal), 'h'}};
  std::tie(f.share, f.requirement, f.axis) = candidates[0];
  for (const auto& candidate : candidates)
    if (std::get<double>(candidate) > f.share || std::isnan(f.share))
      std::tie(f.share, f.requirement, f.axis) = candidate;
}

}  // namespace

double share_of_limit(double value, double limit) {
  if (limit > 0) return value / limit;
  return value > 0 ? std::numeric_limits<double>::infinity() : value;
}

std::vector<BinIndex> largest_apart(const Grid<float>& map, std::int64_t half_bins, std::size_t count) {
  const auto rows = static_cast<std::size_t>(map.spec().rows);
  std::vector<std::int64_t> best(rows, -1);
  Chosen chosen;
  const auto value = [&](std::size_t row) { return map.at({static_cast<std::int64_t>(row), best[row]}); };
  const auto search = [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const auto r = static_cast<std::int64_t>(row);
      const bool near = !chosen.empty() && std::abs(r - chosen.back().row) <= 2 * half_bins;
      if (chosen.empty() || near) best[row] = best_of_row(map.row(r), r, chosen, half_bins);
    }
  };
  while (chosen.size() < count) {
    parallel_for(rows, 64, search);
    std::size_t found = rows;
    for (std::size_t row = 0; row < rows; ++row)
      if (best[row] >= 0 && (found == rows || value(row) > value(found))) found = row;
    if (found == rows) break;
    chosen.push_back({static_cast<std::int64_t>(found), best[found]});
  }
  return chosen;
}

WorstFootprint measure_footprint(BinIndex bin, const GridSpec& dem, const EvaluationParameters& parameters,
                                 const DemWindow& read) {
  const FootprintRule rule = footprint_rule(parameters, dem.resolution_m);
  WorstFootprint result;
  result.bin = bin;
  result.window = window_about(bin, 3 * rule.footprint.half_bins() + 3, dem);
  DemLayers layers = read(result.window);
  BinMask centre(result.window);
  const BinIndex within{bin.row + dem.first_row - result.window.first_row,
                        bin.col + dem.first_col - result.window.first_col};
  centre.at(within) = 1;
  ErrorLayers errors = errors_of(std::move(*layers.truth), layers.z_est);
  std::ranges::fill(result.absolute_m, std::numeric_limits<double>::quiet_NaN());
  std::ranges::fill(result.relative_m, std::numeric_limits<double>::quiet_NaN());
  for (const auto& [axis, error] :
       {std::pair(Axis::x, &errors.x), std::pair(Axis::y, &errors.y), std::pair(Axis::z, &errors.z)}) {
    if (error->spec().size() == 0) continue;  // not judged
    const FootprintStatistics found = footprint_statistics(*error, centre, rule);
    result.absolute_m[static_cast<std::size_t>(axis)] = found.mean.at(within);
    result.relative_m[static_cast<std::size_t>(axis)] = found.relative.at(within);
  }
  result.horizontal_m = portable::hypot(result.absolute_m[0], result.absolute_m[1]);
  find_worst(result, parameters.limits);
  result.z_est = std::move(layers.z_est);
  result.error = result.axis == 'z'   ? std::move(errors.z)
                 : result.axis == 'x' ? std::move(errors.x)
                 : result.axis == 'y' ? std::move(errors.y)
                                      : horizontal_error(std::move(errors.x), errors.y);
  return result;
}

std::vector<WorstFootprint> worst_footprints(const Grid<float>& shares,
                                             const EvaluationParameters& parameters, const DemWindow& read) {
  constexpr std::size_t kMax = 10;
  std::vector<WorstFootprint> result;
  if (shares.values().empty()) return result;
  const GridSpec& dem = shares.spec();
  const std::int64_t half = footprint_of(parameters, dem.resolution_m).half_bins();
  for (const BinIndex bin : largest_apart(shares, half, kMax))
    result.push_back(measure_footprint(bin, dem, parameters, read));
  return result;
}

}  // namespace landfall::html_report
