// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D437
#include "chain/terrain/relief/geodetic_extent.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace landfall {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace

void GeodeticExtentSearch::Range::add(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

void GeodeticExtentSearch::add(const LonLat& lon_lat) {
  if (!std::isfinite(lon_lat.lon_rad) || !std::isfinite(lon_lat.lat_rad)) return;
  lon_.add(lon_lat.lon_rad);
  lat_.add(lon_lat.lat_rad);
  const double lon_rad = lon_lat.lon_rad - kTurn * std::floor(lon_lat.lon_rad / kTurn);
  const auto sector = static_cast<std::size_t>(std::clamp(lon_rad / kTurn, 0.0, 1.0) * kSectors);
  sectors_[std::min(sector, kSectors - 1)].add(lon_rad);
}

std::optional<GeodeticExtent> GeodeticExtentSearch::across_seam() const {
  if (lon_.empty()) return std::nullopt;
  constexpr double kRounding = 1e-12;
  double widest = kTurn - (lon_.high - lon_.low) + kRounding;
  std::optional<GeodeticExtent> extent;
  const auto filled = [](const Range& sector) { return !sector.empty(); };
  const Range& last = *std::find_if(sectors_.rbegin(), sectors_.rend(), filled);
  double before = last.high - kTurn;
  for (const Range& sector : sectors_) {
    if (sector.empty()) continue;
    if (sector.low - before > widest) {
      widest = sector.low - before;
      extent = {{sector.low, lat_.low}, {before + kTurn, lat_.high}};
    }
    before = sector.high;
  }
  return extent;
}

}  // namespace landfall
