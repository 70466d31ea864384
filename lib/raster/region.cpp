// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D21, D61
#include "raster/region.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>

#include "base/error.h"

namespace landfall {
namespace {

double ratio_of(double radius_m, double resolution_m) {
  const double ratio = radius_m / resolution_m;
  const double whole = std::nearbyint(ratio);
  return std::abs(ratio - whole) <= 1e-9 ? whole : ratio;
}

/// Bins from the origin to the nearest border of the DEM; negative if the origin is outside.
std::int64_t margin_bins(const GridSpec& dem) {
  return std::min(
      {-dem.first_row, -dem.first_col, dem.first_row + dem.rows - 1, dem.first_col + dem.cols - 1});
}

/// `beyond` is the number of bins by which the length may exceed the last bin that fits.
[[noreturn]] void refuse(const GridSpec& dem, const std::string& key, double length_m, std::int64_t beyond) {
  const std::int64_t margin = margin_bins(dem);
  std::ostringstream message;
  message.precision(12);
  message << key << ": " << length_m << " does not fit the DEM";
  if (margin < 0)
    message << ", which does not hold the origin: no region fits";
  else
    message << ": the largest that fits is " << static_cast<double>(margin + beyond) * dem.resolution_m;
  throw UsageError(message.str());
}

/// The squares of this many bins can be added exactly.
constexpr double kMaxRadiusBins = 0x1p30;

/// radius_bins is at most kMaxRadiusBins.
BinMask circle(const GridSpec& dem, double radius_bins) {
  const bool whole = radius_bins == std::floor(radius_bins);
  const auto whole_radius = static_cast<std::int64_t>(radius_bins);
  const auto inside = [&](std::int64_t squared) {
    return whole ? squared < whole_radius * whole_radius
                 : static_cast<double>(squared) < radius_bins * radius_bins;
  };
  BinMask region(dem);
  const auto is_near = [&](std::int64_t bins) { return std::abs(bins) <= whole_radius; };
  for (std::int64_t row = 0; row < dem.rows; ++row) {
    const std::int64_t i = dem.first_row + row;
    if (!is_near(i)) continue;
    for (std::int64_t col = 0; col < dem.cols; ++col) {
      const std::int64_t j = dem.first_col + col;
      region.at({row, col}) = is_near(j) && inside(i * i + j * j) ? 1 : 0;
    }
  }
  return region;
}

template <class T, class Predicate>
BinBox box_of(const Grid<T>& grid, const Predicate& holds) {
  const GridSpec& spec = grid.spec();
  BinBox box{{spec.rows, spec.cols}, {-1, -1}};
  for (std::int64_t row = 0; row < spec.rows; ++row) {
    const auto values = grid.row(row);
    const auto begin = std::ranges::find_if(values, holds);
    if (begin == values.end()) continue;
    const auto end = std::find_if(values.rbegin(), values.rend(), holds).base();
    box.first = {std::min(box.first.row, row), std::min<std::int64_t>(box.first.col, begin - values.begin())};
    box.last = {row, std::max<std::int64_t>(box.last.col, end - values.begin() - 1)};
  }
  return box;
}

}  // namespace

BinBox set_box(const BinMask& mask) {
  return box_of(mask, [](std::int8_t is_set) { return is_set != 0; });
}

BinBox valid_box(const Grid<double>& z_est) {
  return box_of(z_est, [](double z) { return !std::isnan(z); });
}

BinMask circular_region(const GridSpec& dem, double radius_m) {
  const double radius_bins = ratio_of(radius_m, dem.resolution_m);
  const std::int64_t margin = margin_bins(dem);
  // |i| = margin + 1, the first bin outside, is in the region only when radius_bins > margin + 1.
  if (!(radius_bins > 0) || margin < 0 || radius_bins > static_cast<double>(margin + 1))
    refuse(dem, "region_radius_m", radius_m, 1);
  return circle(dem, radius_bins);
}

BinMask clipped_circle(const GridSpec& dem, double radius_m) {
  return circle(dem, std::min(ratio_of(radius_m, dem.resolution_m), kMaxRadiusBins));
}

BinMask square_region(const GridSpec& dem, double half_width_m) {
  const double half_bins = std::floor(half_width_m / dem.resolution_m + 1e-9);
  const std::int64_t margin = margin_bins(dem);
  if (!(half_bins >= 0) || margin < 0 || half_bins > static_cast<double>(margin))
    refuse(dem, "region/half_width_m", half_width_m, 0);
  const auto half = static_cast<std::int64_t>(half_bins);
  auto region = BinMask::unset(dem);
  for (std::int64_t row = 0; row < dem.rows; ++row)
    for (std::int64_t col = 0; col < dem.cols; ++col)
      region.at({row, col}) =
          std::max(std::abs(dem.first_row + row), std::abs(dem.first_col + col)) <= half ? 1 : 0;
  return region;
}

std::int64_t count_set(const BinMask& mask) {
  return static_cast<std::int64_t>(
      std::count_if(mask.values().begin(), mask.values().end(), [](std::int8_t v) { return v != 0; }));
}

}  // namespace landfall
