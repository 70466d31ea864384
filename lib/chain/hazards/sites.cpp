// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D281
#include "chain/hazards/sites.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "base/numerics/portable_math.h"
#include "base/raster/by_rows.h"
#include "base/raster/distance_transform.h"

namespace landfall {
namespace {

constexpr double kTolerance_m = 1e-9;
constexpr float kUnmeasured = std::numeric_limits<float>::quiet_NaN();

/// Weights of offsets 0, 1, ..; their sum over both sides is 1.
std::vector<double> kernel(double sigma_m, double resolution_m) {
  std::vector<double> weights;
  double sum = 0;
  for (std::int64_t k = 0; static_cast<double>(k) * resolution_m <= touchdown_reach_m(sigma_m); ++k) {
    const double x = static_cast<double>(k) * resolution_m / sigma_m;
    weights.push_back(k == 0 ? 1 : portable::exp(-x * x / 2));
    sum += k == 0 ? weights.back() : 2 * weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Adds weight times what lies `offset` bins before and behind each value.
void add_neighbours(std::span<const double> values, std::int64_t offset, double weight,
                    std::span<double> sums) {
  const auto count = static_cast<std::int64_t>(values.size());
  for (std::int64_t i = offset; i < count; ++i)
    sums[static_cast<std::size_t>(i)] += weight * values[static_cast<std::size_t>(i - offset)];
  if (offset == 0) return;
  for (std::int64_t i = 0; i + offset < count; ++i)
    sums[static_cast<std::size_t>(i)] += weight * values[static_cast<std::size_t>(i + offset)];
}

double distance_to_origin(const GridSpec& spec, BinIndex bin) {
  return portable::hypot(spec.x(bin.col), spec.y(bin.row));
}

std::int64_t squared_bins(const GridSpec& spec, BinIndex bin) {
  const std::int64_t x = spec.first_col + bin.col;
  const std::int64_t y = spec.first_row + bin.row;
  return x * x + y * y;
}

}  // namespace

Grid<float> touchdown_probability(const Grid<float>& p, double sigma_m, const BinMask& region) {
  const GridSpec& spec = p.spec();
  const std::vector<double> weights =
      sigma_m > 0 ? kernel(sigma_m, spec.resolution_m) : std::vector<double>{1};
  Grid<double> along_x(spec);
  by_rows(spec, [&](std::int64_t row) {
    std::vector<double> values;
    for (const float value : p.row(row)) values.push_back(std::isnan(value) ? 0 : static_cast<double>(value));
    for (std::size_t k = 0; k < weights.size(); ++k)
      add_neighbours(values, static_cast<std::int64_t>(k), weights[k], along_x.row(row));
  });
  Grid<float> result(spec, kUnmeasured);
  by_rows(spec, [&](std::int64_t row) {
    std::vector<double> sums(static_cast<std::size_t>(spec.cols));
    const auto add = [&](std::int64_t from, double weight) {
      if (from < 0 || from >= spec.rows) return;
      const std::span<const double> values = std::as_const(along_x).row(from);
      for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += weight * values[c];
    };
    add(row, weights[0]);
    for (std::size_t k = 1; k < weights.size(); ++k) {
      add(row - static_cast<std::int64_t>(k), weights[k]);
      add(row + static_cast<std::int64_t>(k), weights[k]);
    }
    for (std::size_t c = 0; c < sums.size(); ++c)
      if (region.row(row)[c] != 0) result.row(row)[c] = static_cast<float>(sums[c]);
  });
  return result;
}

ReachableArea reachable_area(const SiteParameters& parameters) {
  return parameters.reach.value_or(ReachableArea::circle(parameters.divert_radius_m));
}

Grid<float> landing_cost(const Grid<float>& p_touchdown, const SiteParameters& parameters) {
  const GridSpec& spec = p_touchdown.spec();
  Grid<float> cost(spec, kUnmeasured);
  const ReachableArea area = reachable_area(parameters);
  by_rows(spec, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      if (!area.contains({spec.x(col), spec.y(row)})) continue;
      const double distance = distance_to_origin(spec, {row, col});
      const double p = p_touchdown.at({row, col});
      cost.at({row, col}) =
          static_cast<float>(1 - p + parameters.divert_weight * distance / parameters.divert_radius_m);
    }
  });
  return cost;
}

Grid<float> hazard_distance(const Grid<std::int8_t>& safe, const BinMask& region) {
  const GridSpec& spec = safe.spec();
  BinMask hazards(spec);
  for (std::size_t i = 0; i < spec.size(); ++i)
    hazards.values()[i] =
        region.values()[i] != 0 && safe.values()[i] != static_cast<std::int8_t>(Safety::safe) ? 1 : 0;
  const Grid<std::int64_t> squared = squared_distance(hazards);
  Grid<float> distance(spec, kUnmeasured);
  for (std::size_t i = 0; i < spec.size(); ++i)
    if (region.values()[i] != 0 && squared.values()[i] != kNoValidBin)
      distance.values()[i] = static_cast<float>(bins_apart(squared.values()[i]) * spec.resolution_m);
  return distance;
}

double touchdown_reach_m(double sigma_m) { return 3 * sigma_m + kTolerance_m; }

bool is_apart(const GridSpec& spec, BinIndex a, BinIndex b, const SiteParameters& parameters) {
  return a != b && portable::hypot(spec.x(a.col) - spec.x(b.col), spec.y(a.row) - spec.y(b.row)) >=
                       parameters.separation_m - kTolerance_m;
}

bool is_better(const GridSpec& spec, const SitePlace& a, const SitePlace& b) {
  if (a.cost != b.cost) return a.cost < b.cost;
  const std::int64_t from_a = squared_bins(spec, a.bin);
  const std::int64_t from_b = squared_bins(spec, b.bin);
  if (from_a != from_b) return from_a < from_b;
  return a.bin.row != b.bin.row ? a.bin.row < b.bin.row : a.bin.col < b.bin.col;
}

std::optional<SitePlace> best_place(const Grid<float>& cost, const Grid<std::int8_t>& safe,
                                    std::span<const BinIndex> sites, const SiteParameters& parameters) {
  const GridSpec& spec = cost.spec();
  std::optional<SitePlace> best;
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const SitePlace here{{row, col}, cost.at({row, col})};
      if (std::isnan(here.cost) || safe.at(here.bin) != static_cast<std::int8_t>(Safety::safe)) continue;
      if (best && !is_better(spec, here, *best)) continue;
      if (std::ranges::all_of(sites,
                              [&](BinIndex site) { return is_apart(spec, here.bin, site, parameters); }))
        best = here;
    }
  return best;
}

std::vector<BinIndex> choose_sites(const Grid<float>& cost, const Grid<std::int8_t>& safe,
                                   const SiteParameters& parameters) {
  std::vector<BinIndex> sites;
  while (static_cast<std::int64_t>(sites.size()) < parameters.count) {
    const std::optional<SitePlace> best = best_place(cost, safe, sites, parameters);
    if (!best) break;
    sites.push_back(best->bin);
  }
  return sites;
}

}  // namespace landfall
