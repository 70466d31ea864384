// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/geodetic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "constants.h"

namespace landfall {
namespace {

/// Helmert's formulas, the inverse of geodetic_of().
Eigen::Vector3d body_fixed(const Ellipsoid& body, const Geodetic& at) {
  const double e2 = body.flattening * (2 - body.flattening);
  const double s = std::sin(at.lon_lat.lat_rad);
  const double normal_m = body.semi_major_m / std::sqrt(1 - e2 * s * s);
  const double axis_m = (normal_m + at.height_m) * std::cos(at.lon_lat.lat_rad);
  return {axis_m * std::cos(at.lon_lat.lon_rad), axis_m * std::sin(at.lon_lat.lon_rad),
          (normal_m * (1 - e2) + at.height_m) * s};
}

TEST(Geodetic, UndoesHelmertsFormulas) {
  for (const Ellipsoid& body : {Ellipsoid{6378137, 1 / 298.257223563}, Ellipsoid{1737400, 0},
                                Ellipsoid{245, 0.1}, Ellipsoid{13000, 0.3}})
    for (const double height : {-0.02, 0.0, 0.001, 0.5})
      for (double lat = -kPi / 2; lat <= kPi / 2; lat += kPi / 24)
        for (const double lon : {-3.0, 0.0, 1.5}) {
          const double height_m = height * body.semi_major_m;
          const Geodetic found = geodetic_of(body, body_fixed(body, {{lon, lat}, height_m}));
          EXPECT_NEAR(found.height_m, height_m, 1e-15 * body.semi_major_m + 4e-9);
          EXPECT_NEAR(found.lon_lat.lat_rad, lat, 3e-15) << body.flattening << ' ' << height;
          if (std::abs(lat) < 1.57) {
            EXPECT_NEAR(found.lon_lat.lon_rad, lon, 1e-15);
          }
        }
}

TEST(Geodetic, TheCentreOfTheBodyHasNoPlace) {
  EXPECT_TRUE(std::isnan(geodetic_of({6378137, 0}, {0, 0, 0}).height_m));
}

}  // namespace
}  // namespace landfall
