// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/incidence.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace landfall {
namespace {

/// z = slope_x x on 3 x 3 nodes.
TriangulatedGrid plane(double slope_x) {
  Grid<double> nodes(GridSpec::centered(1, 1));
  for (std::int64_t r = 0; r < 3; ++r)
    for (std::int64_t c = 0; c < 3; ++c) nodes.at({r, c}) = slope_x * nodes.spec().x(c);
  return TriangulatedGrid(std::move(nodes));
}

/// A beam in the x-z plane, `off_nadir_rad` from straight down towards +x.
Direction<DemFrame> beam(double off_nadir_rad) {
  return {{std::sin(off_nadir_rad), 0, -std::cos(off_nadir_rad)}};
}

// A plane that rises to +x by `tilt` meets a beam leaning to +x by `lean` at tilt - lean from its normal.
TEST(Incidence, IsTiltMinusLean) {
  for (const double tilt : {-0.5, 0.0, 0.3})
    for (const double lean : {-0.2, 0.0, 1e-9, 0.4}) {
      const double measured =
          tan_incidence(plane(std::tan(tilt)), {{0.2, 0.1, std::tan(tilt) * 0.2}}, beam(lean));
      EXPECT_NEAR(measured, std::tan(std::abs(tilt - lean)), 1e-15) << tilt << ' ' << lean;
    }
}

TEST(Incidence, EndsAt89Degrees) {
  EXPECT_NEAR(tan_incidence(plane(0), {{0, 0, 0}}, beam(kPi / 2)), std::tan(89 * kPi / 180), 1e-9);
  EXPECT_NEAR(tan_incidence(plane(0), {{0, 0, 0}}, beam(89.7 * kPi / 180)), std::tan(89 * kPi / 180), 1e-9);
  EXPECT_NEAR(tan_incidence(plane(0), {{0, 0, 0}}, beam(88 * kPi / 180)), std::tan(88 * kPi / 180), 1e-12);
}

TEST(Incidence, HolesHaveNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(tan_incidence(plane(nan), {{0, 0, 0}}, beam(0.3)), 0);
  EXPECT_TRUE(std::isnan(tan_incidence(plane(0), {{nan, nan, nan}}, beam(0))));
}

}  // namespace
}  // namespace landfall
