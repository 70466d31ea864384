// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "bins.h"
#include "chain/gridding/accumulators.h"
#include "return_columns.h"
#include "test_seed.h"

namespace landfall {

/// Random returns, some outside the grid, some on edges and centres, elevations often equal.
inline std::vector<ReturnPoint> random_points(const GridSpec& spec, std::size_t count) {
  std::mt19937_64 random(test_seed());
  const double reach = spec.x(spec.cols - 1) * 1.2;
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::uniform_int_distribution<int> step(0, 12);
  std::vector<ReturnPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    ReturnPoint& p = points[i];
    p.x_est = coordinate(random);
    p.y_est = coordinate(random);
    if (i % 10 == 0) p.x_est = std::round(p.x_est / spec.resolution_m * 2) / 2 * spec.resolution_m;
    if (i % 15 == 0) p.y_est = std::round(p.y_est / spec.resolution_m * 2) / 2 * spec.resolution_m;
    p.z_est = 100 + 0.25 * step(random);
    p.z_true = p.z_est - 0.01;
    p.x_true = p.x_est + 0.01 * step(random);
    p.y_true = p.y_est - 0.01 * step(random);
    p.t = static_cast<double>(i) * 1e-3;
  }
  return points;
}

/// A return and its weight in a bin.
struct Member {
  ReturnPoint point;
  double weight;
};
using Members = std::map<std::pair<std::int64_t, std::int64_t>, std::vector<Member>>;

/// Which returns each bin sees, by trying every bin for every return.
inline Members members_of(Method method, const GridSpec& spec, const std::vector<ReturnPoint>& points) {
  Members members;
  const double s = spec.resolution_m;
  for (const ReturnPoint& p : points)
    for (const auto [row, col] : bins_of(spec)) {
      const double u = p.x_est / s - static_cast<double>(spec.first_col + col);
      const double v = p.y_est / s - static_cast<double>(spec.first_row + row);
      const double weight = (1 - std::abs(u)) * (1 - std::abs(v));
      const bool nearest = u >= -0.5 && u < 0.5 && v >= -0.5 && v < 0.5;
      const bool around = std::abs(u) < 1 && std::abs(v) < 1;
      if (method == Method::bilinear4 ? around : nearest)
        members[{row, col}].push_back(
            {p, method == Method::bilinear4 || method == Method::bilinear_nearest ? weight : 1.0});
    }
  return members;
}

/// sum w f / sum w
template <class Value>
double mean(const std::vector<Member>& members, Value value) {
  double sum = 0;
  double weights = 0;
  for (const Member& m : members) {
    sum += m.weight * value(m.point);
    weights += m.weight;
  }
  return sum / weights;
}

}  // namespace landfall
