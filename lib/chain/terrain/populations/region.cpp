// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/populations/region.h"

#include <algorithm>
#include <cmath>

#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

Box box_about(const SitePoint& center, double half_x_m, double half_y_m) {
  return {center.x_m - half_x_m, center.x_m + half_x_m, center.y_m - half_y_m, center.y_m + half_y_m};
}

Box bounds(const RectangleRegion& r) { return box_about(r.center, r.width_m / 2, r.length_m / 2); }

void validate_center(const SitePoint& center, const std::string& owner) {
  require_finite({owner, "x_m"}, center.x_m);
  require_finite({owner, "y_m"}, center.y_m);
}

struct Validator {
  const std::string& owner;

  void operator()(const SiteRegion& /*site*/) const {}
  void operator()(const RectangleRegion& r) const {
    validate_center(r.center, owner);
    require_positive({owner, "width_m"}, r.width_m);
    require_positive({owner, "length_m"}, r.length_m);
  }
  void operator()(const AnnulusRegion& r) const {
    validate_center(r.center, owner);
    require_positive({owner, "outer_radius_m"}, r.outer_radius_m);
    require(r.inner_radius_m >= 0 && r.inner_radius_m < r.outer_radius_m, {owner, "inner_radius_m"},
            r.inner_radius_m, "in [0, the outer radius)");
  }
};

struct BoundsWithin {
  const Box& site;

  Box operator()(const SiteRegion& /*region*/) const { return site; }
  Box operator()(const RectangleRegion& r) const { return site.common(bounds(r)); }
  Box operator()(const AnnulusRegion& r) const {
    return site.common(box_about(r.center, r.outer_radius_m, r.outer_radius_m));
  }
};

struct Contains {
  const SitePoint& point;

  bool operator()(const SiteRegion& /*region*/) const { return true; }
  bool operator()(const RectangleRegion& r) const { return bounds(r).contains(point); }
  bool operator()(const AnnulusRegion& r) const {
    const double distance_m = portable::hypot(point.x_m - r.center.x_m, point.y_m - r.center.y_m);
    return distance_m >= r.inner_radius_m && distance_m <= r.outer_radius_m;
  }
};

}  // namespace

Box Box::common(const Box& other) const {
  return {std::max(west_m, other.west_m), std::min(east_m, other.east_m), std::max(south_m, other.south_m),
          std::min(north_m, other.north_m)};
}

void validate(const Region& region, const std::string& owner) { std::visit(Validator{owner}, region); }

Box bounds(const Region& region, const Box& site) { return std::visit(BoundsWithin{site}, region); }

bool contains(const Region& region, const SitePoint& point) { return std::visit(Contains{point}, region); }

}  // namespace landfall
