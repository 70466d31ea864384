// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D21, D61
#include "base/raster/region.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>

#include "base/core/error.h"

namespace landfall {
namespace {

double ratio_of(double radius_m, double resolution_m) {
  const double ratio = radius_m / resolution_m;
  const double whole = std::nearbyint(ratio);
  return std::abs(ratio - whole) <= 1e-9 ? whole : ratio;
}

/// A place in bins from the origin.
struct BinPlace {
  double row = 0, col = 0;
};

BinPlace in_bins(const GridSpec& dem, Horizontal place) {
  return {ratio_of(place.y, dem.resolution_m), ratio_of(place.x, dem.resolution_m)};
}

/// Bins from the centre to the nearest border bin of the DEM; negative if the centre lies outside them.
double margin_bins(const GridSpec& dem, const BinPlace& centre) {
  const auto first_row = static_cast<double>(dem.first_row);
  const auto first_col = static_cast<double>(dem.first_col);
  return std::min({centre.row - first_row, centre.col - first_col,
                   first_row + static_cast<double>(dem.rows - 1) - centre.row,
                   first_col + static_cast<double>(dem.cols - 1) - centre.col});
}

/// `beyond` is the number of bins by which the length may exceed the last bin that fits.
[[noreturn]] void refuse(const GridSpec& dem, const std::string& key, double length_m, int beyond,
                         Horizontal center = {}) {
  const double margin = margin_bins(dem, in_bins(dem, center));
  const bool is_origin = center == Horizontal{};
  std::ostringstream message;
  message.precision(12);
  message << key << ": " << length_m << " does not fit the DEM";
  if (margin < 0)
    message << ", which does not hold the " << (is_origin ? "origin" : "centre") << ": no region fits"
            << (is_origin ? "" : " there");
  else
    message << ": the largest that fits " << (is_origin ? "" : "there ") << "is "
            << (margin + beyond) * dem.resolution_m;
  throw UsageError(message.str());
}

/// The squares of this many bins can be added exactly.
constexpr double kMaxRadiusBins = 0x1p30;

bool is_whole(double bins) { return bins == std::floor(bins); }

/// The radius is at most kMaxRadiusBins.
BinMask exact_circle(const GridSpec& dem, double radius_bins, const BinPlace& centre) {
  const auto radius = static_cast<std::int64_t>(radius_bins);
  const auto row0 = static_cast<std::int64_t>(centre.row) - dem.first_row;
  const auto col0 = static_cast<std::int64_t>(centre.col) - dem.first_col;
  BinMask region(dem);
  for (std::int64_t row = std::max<std::int64_t>(0, row0 - radius);
       row <= std::min(dem.rows - 1, row0 + radius); ++row)
    for (std::int64_t col = std::max<std::int64_t>(0, col0 - radius);
         col <= std::min(dem.cols - 1, col0 + radius); ++col) {
      const std::int64_t i = row - row0;
      const std::int64_t j = col - col0;
      region.at({row, col}) = i * i + j * j < radius * radius ? 1 : 0;
    }
  return region;
}

BinMask circle_of(const GridSpec& dem, double radius_bins, const BinPlace& centre) {
  if (is_whole(radius_bins) && is_whole(centre.row) && is_whole(centre.col))
    return exact_circle(dem, radius_bins, centre);
  BinMask region(dem);
  for (std::int64_t row = 0; row < dem.rows; ++row) {
    const double i = static_cast<double>(dem.first_row + row) - centre.row;
    for (std::int64_t col = 0; col < dem.cols; ++col) {
      const double j = static_cast<double>(dem.first_col + col) - centre.col;
      region.at({row, col}) = i * i + j * j < radius_bins * radius_bins ? 1 : 0;
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

BinMask circular_region(const GridSpec& dem, double radius_m, Horizontal center) {
  const double radius_bins = ratio_of(radius_m, dem.resolution_m);
  const BinPlace centre = in_bins(dem, center);
  const double margin = margin_bins(dem, centre);
  // At margin + 1 lies the first bin outside: it is in the region only when radius_bins > margin + 1.
  if (!(radius_bins > 0) || margin < 0 || radius_bins > margin + 1)
    refuse(dem, "region_radius_m", radius_m, 1, center);
  return circle_of(dem, radius_bins, centre);
}

BinMask clipped_circle(const GridSpec& dem, double radius_m, Horizontal center) {
  const BinPlace centre = in_bins(dem, center);
  const auto bounded = [](double bins) { return std::clamp(bins, -kMaxRadiusBins, kMaxRadiusBins); };
  return circle_of(dem, bounded(ratio_of(radius_m, dem.resolution_m)),
                   {bounded(centre.row), bounded(centre.col)});
}

BinMask square_region(const GridSpec& dem, double half_width_m) {
  const double half_bins = std::floor(half_width_m / dem.resolution_m + 1e-9);
  const double margin = margin_bins(dem, {});
  if (!(half_bins >= 0) || margin < 0 || half_bins > margin)
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
  return std::ranges::count_if(mask.values(), [](std::int8_t v) { return v != 0; });
}

}  // namespace landfall
