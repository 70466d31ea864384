// SPDX-License-Identifier: GPL-3.0-or-later
// Methods other than `contact` need no legs: `leg_radius_m` may be less than 2 bins, and a lander fits the
// map if its body does, or for `range_difference` if its windows do. The body must reach 1 bin, because a
// plane or window of one bin has no slope; for `lmeds` 2 bins, because with 5 samples the plane through
// any three of them has a median of 0. With every method, a lander that no place of the map can hold is a
// wrong configuration (exit 2); a region whose holes leave no place is a fault of the data (exit 1).
#include "chain/hazards/lander.h"

#include <cmath>
#include <numbers>
#include <string>

#include "base/core/error.h"
#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

constexpr double kLanderTolerance = 1e-9;  // bins, and metres

/// The nearest integer, halves away from zero.
std::int64_t nearest(double bins) {
  const double whole = std::floor(std::abs(bins) + 0.5 + kLanderTolerance);
  return static_cast<std::int64_t>(bins < 0 ? -whole : whole);
}

Footprint disc(double radius_m, double resolution_m) {
  const double bins = (radius_m + kLanderTolerance) / resolution_m;
  return Footprint::disc(static_cast<std::int64_t>(std::floor(bins * bins)));
}

const Lander& checked_lander(const Lander& lander, double resolution_m) {
  if (lander.legs != 3 && lander.legs != 4)
    throw UsageError("lander/legs: " + std::to_string(lander.legs) + " is not 3 or 4");
  require_positive({"lander", "leg_radius_m"}, lander.leg_radius_m);
  require_positive({"lander", "pad_diameter_m"}, lander.pad_diameter_m);
  require_positive({"lander", "body_radius_m"}, lander.body_radius_m);
  require_bins({"lander/leg_radius_m", lander.leg_radius_m, 2}, resolution_m);
  return lander;
}

PadOffsets pads(const Lander& lander, double resolution_m, double yaw_rad) {
  const double radius = lander.leg_radius_m / resolution_m;
  PadOffsets found{};
  for (int leg = 0; leg < lander.legs; ++leg) {
    BinOffset& pad = found[static_cast<std::size_t>(leg)];
    if (leg > 0 && lander.legs == 4) {
      const BinOffset& last = found[static_cast<std::size_t>(leg - 1)];
      pad = {last.cols, -last.rows};
      continue;
    }
    const double angle = yaw_rad + 2 * std::numbers::pi * leg / lander.legs;
    pad = {nearest(radius * portable::sin(angle)), nearest(radius * portable::cos(angle))};
  }
  return found;
}

}  // namespace

void require_bins(const LengthInBins& length, double resolution_m) {
  if (length.length_m >= length.min_bins * resolution_m - kLanderTolerance) return;
  const std::string remark = *length.remark == '\0' ? "" : std::string(", ") + length.remark;
  throw UsageError(std::string(length.key) + ": " + number_text(length.length_m) + " is less than " +
                   (length.min_bins == 1 ? "1 bin" : std::to_string(length.min_bins) + " bins") + " of " +
                   number_text(resolution_m) + " m" + remark + "; make it at least " +
                   number_text(length.min_bins * resolution_m) + " m, or the bins at most " +
                   number_text(length.length_m / length.min_bins) + " m wide");
}

LanderStencil::LanderStencil(const Lander& lander, double resolution, double yaw_rad)
    : legs(checked_lander(lander, resolution).legs),
      resolution_m(resolution),
      pad_height(lander.pad_height),
      yaws({pads(lander, resolution, yaw_rad)}),
      pad(disc(lander.pad_diameter_m / 2, resolution)),
      body(disc(lander.body_radius_m, resolution)) {}

LanderStencil::LanderStencil(const Lander& lander, double resolution) : LanderStencil(lander, resolution, 0) {
  yaws.clear();
  const double sector = 2 * std::numbers::pi / legs;
  const double count = std::ceil(sector * lander.leg_radius_m / resolution - kLanderTolerance);
  for (int m = 0; m < static_cast<int>(count); ++m)
    yaws.push_back(pads(lander, resolution, m * sector / count));
}

}  // namespace landfall
