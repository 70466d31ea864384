// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "base/core/parallel.h"
#include "base/raster/grid.h"
#include "bins.h"
#include "chain/hazards/lander.h"
#include "chain/hazards/measures.h"
#include "constants.h"

namespace landfall::testing_hazards {

/// The definitions, place by place, with no code of lib/chain/hazards.
struct BruteForce {
  const Grid<double>& z;
  const Lander& lander;

  struct Measures {
    double slope_deg = -1;
    double roughness_m = -std::numeric_limits<double>::infinity();
  };
  struct Bin {
    std::int64_t x, y;
  };
  struct Plane {
    double east, north, height;  ///< of a step of one bin; at the centre
  };

  [[nodiscard]] std::int64_t within(double radius_m) const {
    return static_cast<std::int64_t>(std::ceil(radius_m / z.spec().resolution_m)) + 1;
  }
  [[nodiscard]] bool covers(double radius_m, Bin b) const {
    const double s = z.spec().resolution_m;
    return std::hypot(static_cast<double>(b.x) * s, static_cast<double>(b.y) * s) <= radius_m + 1e-9;
  }
  [[nodiscard]] std::optional<double> at(BinIndex place, Bin b) const {
    const BinIndex bin{place.row + b.y, place.col + b.x};
    if (!z.spec().contains(bin) || std::isnan(z.at(bin))) return {};
    return z.at(bin);
  }

  [[nodiscard]] std::vector<std::vector<Bin>> yaws() const {
    const double sector = 2 * std::numbers::pi / lander.legs;
    const double s = z.spec().resolution_m;
    const auto steps = static_cast<int>(std::ceil(sector * lander.leg_radius_m / s - 1e-9));
    const auto rounded = [](double v) {
      return static_cast<std::int64_t>((v < 0 ? -1 : 1) * std::floor(std::abs(v) + 0.5 + 1e-9));
    };
    std::vector<std::vector<Bin>> all;
    for (int m = 0; m < steps; ++m) {
      std::vector<Bin> pads;
      for (int k = 0; k < lander.legs; ++k) {
        const double angle = m * sector / steps + k * sector;
        const double radius = lander.leg_radius_m / s;
        pads.push_back(k > 0 && lander.legs == 4
                           ? Bin{-pads.back().y, pads.back().x}
                           : Bin{rounded(radius * std::cos(angle)), rounded(radius * std::sin(angle))});
      }
      all.push_back(pads);
    }
    return all;
  }

  [[nodiscard]] std::optional<double> pad_height(BinIndex place, Bin pad) const {
    const std::int64_t n = within(lander.pad_diameter_m / 2);
    double highest = -std::numeric_limits<double>::infinity();
    double sum = 0;
    int count = 0;
    for (const auto [y, x] : Bins({-n, -n}, {n + 1, n + 1})) {
      if (!covers(lander.pad_diameter_m / 2, {x, y})) continue;
      const auto height = at(place, {pad.x + x, pad.y + y});
      if (!height) return {};
      highest = std::max(highest, *height);
      sum += *height;
      ++count;
    }
    return lander.pad_height == PadHeight::max ? highest : sum / count;
  }

  /// Through three points, by Cramer's rule about the first.
  static Plane through(std::array<Bin, 3> p, std::array<double, 3> h) {
    const auto x = [&](int i) { return static_cast<double>(p[static_cast<std::size_t>(i)].x - p[0].x); };
    const auto y = [&](int i) { return static_cast<double>(p[static_cast<std::size_t>(i)].y - p[0].y); };
    const double determinant = x(1) * y(2) - x(2) * y(1);
    const double east = ((h[1] - h[0]) * y(2) - (h[2] - h[0]) * y(1)) / determinant;
    const double north = ((h[2] - h[0]) * x(1) - (h[1] - h[0]) * x(2)) / determinant;
    return {east, north, h[0] - east * static_cast<double>(p[0].x) - north * static_cast<double>(p[0].y)};
  }

  [[nodiscard]] std::vector<Plane> planes(const std::vector<Bin>& p, const std::vector<double>& h) const {
    if (lander.legs == 3) return {through({p[0], p[1], p[2]}, {h[0], h[1], h[2]})};
    if (h[0] + h[2] >= h[1] + h[3])
      return {through({p[0], p[2], p[1]}, {h[0], h[2], h[1]}),
              through({p[0], p[2], p[3]}, {h[0], h[2], h[3]})};
    return {through({p[1], p[3], p[0]}, {h[1], h[3], h[0]}), through({p[1], p[3], p[2]}, {h[1], h[3], h[2]})};
  }

  [[nodiscard]] double slope_of(const Plane& plane) const {
    return std::atan(std::hypot(plane.east, plane.north) / z.spec().resolution_m) * 180 / std::numbers::pi;
  }

  /// None: unknown.
  [[nodiscard]] std::optional<Measures> contact(BinIndex place) const {
    Measures maximum;
    const std::int64_t n = within(lander.body_radius_m);
    for (const std::vector<Bin>& pads : yaws()) {
      std::vector<double> heights;
      for (const Bin& pad : pads) {
        const auto height = pad_height(place, pad);
        if (!height) return {};
        heights.push_back(*height);
      }
      for (const Plane& plane : planes(pads, heights)) {
        const double slope = slope_of(plane);
        maximum.slope_deg = std::max(maximum.slope_deg, slope);
        for (const auto [y, x] : Bins({-n, -n}, {n + 1, n + 1})) {
          if (!covers(lander.body_radius_m, {x, y})) continue;
          const auto height = at(place, {x, y});
          if (!height) return {};
          const double terrain =
              plane.height + plane.east * static_cast<double>(x) + plane.north * static_cast<double>(y);
          maximum.roughness_m =
              std::max(maximum.roughness_m, (*height - terrain) * std::cos(slope * std::numbers::pi / 180));
        }
      }
    }
    return maximum;
  }
};

/// Random ground with everything that makes a place hard: noise, a tilt, steps, rocks, holes.
inline Grid<double> random_map(const GridSpec& spec, std::uint64_t seed, double hole_frac) {
  const RandomField field(seed, RandomStream::dropout);
  Grid<double> z(spec);
  const double tilt_x = field.uniform(1) - 0.5;
  const double tilt_y = field.uniform(2) - 0.5;
  const double step = 4 * field.uniform(3) - 2;
  for (const auto [row, col] : bins_of(spec)) {
    const auto i = static_cast<std::uint64_t>(spec.index({row, col}));
    double height = tilt_x * spec.x(col) + tilt_y * spec.y(row) + 0.05 * field.uniform(10 + 3 * i);
    if (col > spec.cols / 2) height += step;
    if (field.uniform(11 + 3 * i) < 0.05) height += field.uniform(12 + 3 * i);
    z.at({row, col}) = field.uniform(1000000 + i) < hole_frac ? kNan : height;
  }
  return z;
}

/// Expects the same bits of `measure` at 1, 2 and 7 threads, where it measures anything.
template <class Measure>
void expect_same_at_any_threads(const Measure& measure) {
  const auto run = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return measure();
  };
  const PlaceMeasures one = run(1);
  for (const std::size_t threads : {2U, 7U}) {
    const PlaceMeasures more = run(threads);
    for (std::size_t i = 0; i < one.slope_deg.values().size(); ++i) {
      if (std::isnan(one.slope_deg.values()[i])) continue;
      EXPECT_EQ(one.slope_deg.values()[i], more.slope_deg.values()[i]);
      EXPECT_EQ(one.roughness_m.values()[i], more.roughness_m.values()[i]);
    }
  }
}

}  // namespace landfall::testing_hazards
