// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <variant>

#include "chain/terrain/site_point.h"

namespace landfall {

/// A rectangle along the axes, metres, frame D; empty where west > east or south > north.
struct Box {
  double west_m = 0;
  double east_m = 0;
  double south_m = 0;
  double north_m = 0;

  [[nodiscard]] bool contains(const SitePoint& point) const {
    return point.x_m >= west_m && point.x_m <= east_m && point.y_m >= south_m && point.y_m <= north_m;
  }
  [[nodiscard]] bool empty() const { return !(west_m <= east_m && south_m <= north_m); }
  [[nodiscard]] double area_m2() const { return (east_m - west_m) * (north_m - south_m); }
  [[nodiscard]] Box widened(double margin_m) const {
    return {west_m - margin_m, east_m + margin_m, south_m - margin_m, north_m + margin_m};
  }
  [[nodiscard]] Box common(const Box& other) const;
  friend bool operator==(const Box&, const Box&) = default;
};

// Regions for the centres of a population, including their borders.

/// The whole site.
struct SiteRegion {
  friend bool operator==(const SiteRegion&, const SiteRegion&) = default;
};

/// A rectangle, width_m along x and length_m along y, about a centre.
struct RectangleRegion {
  SitePoint center;
  double width_m = 0;
  double length_m = 0;
  friend bool operator==(const RectangleRegion&, const RectangleRegion&) = default;
};

/// An annulus about a centre, from inner_radius_m (0: a disc) to outer_radius_m.
struct AnnulusRegion {
  SitePoint center;
  double inner_radius_m = 0;
  double outer_radius_m = 0;
  friend bool operator==(const AnnulusRegion&, const AnnulusRegion&) = default;
};

using Region = std::variant<SiteRegion, RectangleRegion, AnnulusRegion>;

/// Throws UsageError unless every number is finite, sizes are positive and an inner radius is in [0, outer).
void validate(const Region& region, const std::string& owner);
/// The part of `site` that encloses the region.
[[nodiscard]] Box bounds(const Region& region, const Box& site);
/// Whether a point of the site is in the region.
[[nodiscard]] bool contains(const Region& region, const SitePoint& point);

}  // namespace landfall
