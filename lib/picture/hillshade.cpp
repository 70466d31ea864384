// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/hillshade.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace landfall {
namespace {

struct Slope {
  double east = 0;
  double north = 0;
};

/// The slope from the values before and after the middle one; either may be missing.
double slope_between(double before, double middle, double after, double pixel_m) {
  const bool has_before = std::isfinite(before);
  const bool has_after = std::isfinite(after);
  if (has_before && has_after) return (after - before) / (2 * pixel_m);
  if (has_after) return (after - middle) / pixel_m;
  if (has_before) return (middle - before) / pixel_m;
  return 0;
}

Slope slope_at(const PixelMap& map, std::int64_t row, std::int64_t col) {
  const auto value = [&](std::int64_t r, std::int64_t c) {
    const bool inside = r >= 0 && r < map.rows && c >= 0 && c < map.cols;
    return inside ? map.at(r, c) : std::numeric_limits<double>::quiet_NaN();
  };
  const double z = map.at(row, col);
  if (!std::isfinite(z)) return {};
  return {slope_between(value(row, col - 1), z, value(row, col + 1), map.pixel_m),
          slope_between(value(row + 1, col), z, value(row - 1, col), map.pixel_m)};
}

double shade_of(const Slope& slope, double factor) {
  // Normal (-east, -north, 1) times light (-1, 1, sqrt 2) / 2, divided by its value on level ground.
  const double east = factor * slope.east;
  const double north = factor * slope.north;
  const double shade = (east - north + std::numbers::sqrt2) / std::sqrt(1 + east * east + north * north);
  return std::max(0.0, shade / std::numbers::sqrt2);
}

}  // namespace

std::vector<double> hillshade(const PixelMap& elevations) {
  std::vector<Slope> slopes;
  double squares = 0;
  double count = 0;
  for (std::int64_t row = 0; row < elevations.rows; ++row)
    for (std::int64_t col = 0; col < elevations.cols; ++col) {
      slopes.push_back(slope_at(elevations, row, col));
      squares += slopes.back().east * slopes.back().east + slopes.back().north * slopes.back().north;
      count += std::isfinite(elevations.at(row, col)) ? 1 : 0;
    }
  const double rms = count > 0 ? std::sqrt(squares / count) : 0;
  const double factor = rms > 0 ? std::clamp(0.4 / rms, 0.25, 5.0) : 1;
  std::vector<double> shades;
  shades.reserve(slopes.size());
  for (const Slope& slope : slopes) shades.push_back(shade_of(slope, factor));
  return shades;
}

}  // namespace landfall
