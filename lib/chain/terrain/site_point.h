// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

/// A point on the site, metres, frame D: x east, y north of the site centre.
struct SitePoint {
  double x_m = 0;
  double y_m = 0;
  friend bool operator==(const SitePoint&, const SitePoint&) = default;
};

}  // namespace landfall
