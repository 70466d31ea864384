// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D440
#include "formats/points/coordinate_steps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr std::size_t kFewPoints = 64;

double largest(const std::vector<double>& sorted) {
  return std::max(std::abs(sorted.front()), std::abs(sorted.back()));
}

/// The distances between neighbouring values, without those that rounding makes.
std::vector<double> distances(const std::vector<double>& sorted) {
  const double rounding = 1e-15 * largest(sorted);
  std::vector<double> gaps;
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i] - sorted[i - 1] > rounding) gaps.push_back(sorted[i] - sorted[i - 1]);
  return gaps;
}

/// Whether three of four distances are multiples of a step: by chance one of ten is.
bool divides(double step, const std::vector<double>& gaps) {
  constexpr double kSlack = 0.05;
  const auto fitting = std::ranges::count_if(gaps, [&](double gap) {
    const double steps = gap / step;
    return steps > 1 - kSlack && std::abs(steps - std::round(steps)) < kSlack;
  });
  return 4 * static_cast<std::size_t>(fitting) >= 3 * gaps.size();
}

/// The number of points of a sample with the x and y of another one.
std::size_t repeated_places(const PointSample& sample) {
  std::vector<std::pair<double, double>> places(sample.size());
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = {sample[0][i], sample[1][i]};
  std::ranges::sort(places);
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < places.size(); ++i)
    if (places[i] == places[i - 1]) ++repeated;
  return repeated;
}

/// Whether each node of the lattice of the steps has about one point. Points that were rounded to a lattice
/// of this density would meet in many of its nodes.
bool is_raster(const PointSample& sample, double step_x, double step_y, double spacing) {
  const double points_per_node = step_x * step_y / (spacing * spacing);
  if (points_per_node < 0.2 || points_per_node > 1.6) return false;
  const auto size = static_cast<double>(sample.size());
  const double meetings = size * size / 2 * points_per_node / static_cast<double>(sample.point_count());
  return static_cast<double>(repeated_places(sample)) <= meetings / 10;
}

/// The distance between two float32 at most values of a sample; 0 where these are not float32.
double float32_step(const PointSample& sample, std::size_t axis) {
  const auto is_float32 = [](double value) {
    return value == static_cast<double>(static_cast<float>(value));
  };
  if (!std::ranges::all_of(sample[axis], is_float32)) return 0;
  const auto [low, high] = sample.middle_range(axis);
  return std::ldexp(1.0, std::ilogb(std::max({std::abs(low), std::abs(high), 1e-30})) - 23);
}

}  // namespace

double step_of(std::vector<double>& values) {
  std::ranges::sort(values);
  const std::vector<double> gaps = distances(values);
  constexpr std::size_t kFew = 8;  // lines of points, or a step in level terrain
  if (gaps.empty()) return 0;
  if (gaps.size() < kFew && std::ranges::min(gaps) > 1e-3 * largest(values)) return 0;
  std::vector<double> sorted = gaps;
  std::ranges::sort(sorted);
  const auto last = static_cast<double>(sorted.size() - 1);
  for (const double quantile : {0.5, 0.25, 0.1, 0.05, 0.02, 0.01, 0.0}) {
    const double gap = sorted[static_cast<std::size_t>(quantile * last)];
    for (const double part : {1, 2, 3})
      if (divides(gap / part, gaps)) return gap / part;
  }
  return 0;
}

double spacing_of(const PointSample& sample) {
  const std::array range{sample.middle_range(0), sample.middle_range(1)};
  const double width = range[0].second - range[0].first;
  const double height = range[1].second - range[1].first;
  if (!(width > 0 && height > 0)) return 0;
  const auto cells = static_cast<std::size_t>(std::sqrt(static_cast<double>(sample.size()) / 16));
  std::vector<bool> occupied(cells * cells);
  std::size_t inside = 0;
  const auto cell_of = [&](double value, const std::pair<double, double>& of) {
    const double part = (value - of.first) / (of.second - of.first);
    return std::min(static_cast<std::size_t>(part * static_cast<double>(cells)), cells - 1);
  };
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double x = sample[0][i];
    const double y = sample[1][i];
    if (x < range[0].first || x > range[0].second || y < range[1].first || y > range[1].second) continue;
    ++inside;
    occupied[cell_of(y, range[1]) * cells + cell_of(x, range[0])] = true;
  }
  const double covered = width * height * static_cast<double>(std::ranges::count(occupied, true)) /
                         static_cast<double>(cells * cells);
  const double points = static_cast<double>(inside) * static_cast<double>(sample.point_count()) /
                        static_cast<double>(sample.size());
  return std::sqrt(covered / points);
}

std::string coarse_steps(const PointSample& sample, double z_unit, const std::array<bool, 3>& is_float32) {
  if (sample.size() < kFewPoints) return "";
  const double spacing = spacing_of(sample);
  if (spacing == 0) return "";
  std::array<double, 3> steps{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> values = sample[axis];
    steps[axis] = step_of(values);
  }
  if (is_raster(sample, steps[0], steps[1], spacing)) steps = {};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (is_float32[axis]) steps[axis] = std::max(steps[axis], float32_step(sample, axis));
  const std::array<double, 3> units{1, 1, z_unit};
  std::string coarse;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (steps[axis] * units[axis] > spacing / 10)
      coarse += (coarse.empty() ? "" : ", ") + std::string(1, "xyz"[axis]) + " moves in steps of " +
                short_number(steps[axis]);
  if (coarse.empty()) return "";
  return coarse + ": more than a tenth of the spacing of its points, " + short_number(spacing) +
         "; were they stored as float32 or with few digits? Export them in double precision, or as LAS";
}

}  // namespace landfall
