// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/beam_points.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "base/geometry/rotation.h"
#include "targets.h"
#include "test_seed.h"

namespace landfall {
namespace {

// Every instruction set gives the bits of Transform * Point, in whole vectors, blocks and what is left of
// them.
TEST(BeamPoints, AreTheTransformedPoints) {
  std::mt19937_64 random(test_seed());
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Eigen::Vector3d(number(random), number(random), number(random)); };
  const Transform<DemFrame, LidarFrame> T{rotation_from<DemFrame, LidarFrame>({0.1, -0.7, 2.3}),
                                          {100 * vector()}};
  for (const std::size_t count : {1U, 7U, 8U, 64U, 65U, 324U})
    for (const std::size_t per_beam : {1U, 3U}) {
      std::vector<Beam> beams(count);
      for (Beam& beam : beams) beam = {.direction = {vector().normalized()}, .exit = {vector()}};
      std::vector<double> ranges_m(count * per_beam);
      for (double& range_m : ranges_m) range_m = 500 + 100 * number(random);
      ranges_m.back() = std::numeric_limits<double>::quiet_NaN();
      on_every_target([&] {
        std::vector<double> x(ranges_m.size()), y(ranges_m.size()), z(ranges_m.size());
        beam_points(T, beams, ranges_m, {x.data(), y.data(), z.data()});
        for (std::size_t k = 0; k + 1 < ranges_m.size(); ++k) {
          const Beam& beam = beams[k / per_beam];
          const Point<DemFrame> expected = T * (beam.exit + ranges_m[k] * beam.direction);
          ASSERT_EQ(std::bit_cast<std::uint64_t>(x[k]), std::bit_cast<std::uint64_t>(expected.v.x()))
              << count << ' ' << k;
          ASSERT_EQ(std::bit_cast<std::uint64_t>(y[k]), std::bit_cast<std::uint64_t>(expected.v.y()))
              << count << ' ' << k;
          ASSERT_EQ(std::bit_cast<std::uint64_t>(z[k]), std::bit_cast<std::uint64_t>(expected.v.z()))
              << count << ' ' << k;
        }
        EXPECT_TRUE(std::isnan(x.back()) && std::isnan(y.back()) && std::isnan(z.back()));
      });
    }
}

}  // namespace
}  // namespace landfall
