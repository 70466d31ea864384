// SPDX-License-Identifier: GPL-3.0-or-later
// The engine opencl answers what the heightfield engine answers, to the last bit. Its device is pocl's, the
// CPU, unless the machine has another one.
#include "ray/opencl/opencl_engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "no_opencl.h"
#include "ray/heightfield_engine.h"
#include "ray/windowed_terrain.h"
#include "scenes.h"

namespace landfall {
namespace {

using testing::HasSubstr;

class OpenClEngine : public SceneTest {
 protected:
  void SetUp() override {
    if (!no_opencl().empty()) GTEST_SKIP() << no_opencl();
    SceneTest::SetUp();
  }

  /// Fails unless all ranges equal, and the device decides at least `share` of the rays.
  void expect_same_bits(const std::vector<Ray>& rays, double share) const {
    const auto use = std::make_shared<DeviceUse>();
    const auto engine = make_opencl_engine(terrain_, {.use = use});
    const std::vector<double> ranges = ranges_of(*engine, rays);
    const std::vector<double> expected = ranges_of(*make_heightfield_engine(terrain_), rays);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_TRUE(same_bits(ranges[i], expected[i]))
          << "ray " << i << ": " << ranges[i] << ", heightfield " << expected[i];
    EXPECT_EQ(use->rays(), rays.size());
    EXPECT_FALSE(use->failure());
    EXPECT_LE(static_cast<double>(use->undecided()), (1 - share) * static_cast<double>(rays.size()));
  }
};

INSTANTIATE_TEST_SUITE_P(Scenes, OpenClEngine, every_scene(), scene_name);

TEST_P(OpenClEngine, RaysFromAbove) {
  std::vector<Ray> rays;
  for (int i = 0; i < 20000; ++i)
    rays.push_back(ray_at(Eigen::Vector3d(0, 0, 200) + random_offset(80), random_target()));
  expect_same_bits(rays, 0.95);
}

TEST_P(OpenClEngine, StraightDown) {
  std::vector<Ray> rays;
  for (int i = 0; i < 5000; ++i)
    rays.push_back(ray_from(random_target() + Eigen::Vector3d(0, 0, 30), {0, 0, -1}));
  expect_same_bits(rays, 0.99);
}

TEST_P(OpenClEngine, UpwardLevelAndOverTheSide) {
  std::vector<Ray> rays;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d target = random_target();
    const Eigen::Vector3d side = random_offset(30);
    rays.push_back(ray_at(target - Eigen::Vector3d(0.3, 0.2, 30), target));
    rays.push_back(ray_at(target + Eigen::Vector3d(side.x(), side.y(), 0), target));
    rays.push_back(ray_at(target + Eigen::Vector3d(side.x(), side.y(), 0.1 * side.z()), target));
  }
  expect_same_bits(rays, 0.6);
}

TEST_P(OpenClEngine, RaysFromAmongTheHeights) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < test_rays(); ++i)
    rays.push_back(i % 2 == 0 ? ray_at(random_target() + random_offset(4), random_target())
                              : ray_from(random_target(), random_offset(1)));
  expect_same_bits(rays, 0.05);
}

TEST_P(OpenClEngine, FlatRays) {
  std::vector<Ray> rays;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d target = random_target();
    rays.push_back(
        ray_at(target + Eigen::Vector3d(3, 2, 4 * std::pow(10, uniform(random_, -18, -1))), target));
  }
  expect_same_bits(rays, 0);
}

// Rays at nodes, edges and diagonals, from where they also pass over corners of cells: only the CPU can
// decide.
TEST_P(OpenClEngine, RaysAtNodesEdgesAndDiagonals) {
  const GridSpec& spec = terrain_->nodes().spec();
  std::vector<Ray> rays;
  for (std::size_t id = 0; id < terrain_->triangle_count(); ++id) {
    const auto corners = terrain_->triangle(id);
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d middle = (corners[i] + corners[(i + 1) % 3]) / 2;
      for (const Eigen::Vector3d& target : {corners[i], middle}) {
        if (!target.allFinite()) continue;
        const auto cells = [&] { return spec.resolution_m * std::floor(uniform(random_, -9, 9)); };
        const double diagonal = cells();
        rays.push_back(ray_at(target + Eigen::Vector3d(diagonal, diagonal, 3), target));
        rays.push_back(ray_at(target + Eigen::Vector3d(diagonal, -diagonal, 0.01), target));
        rays.push_back(ray_at(target + Eigen::Vector3d(cells(), cells(), 0.5), target));
        rays.push_back(ray_at(target + Eigen::Vector3d(0, 0, 40) + random_offset(10), target));
      }
    }
  }
  expect_same_bits(rays, 0);
}

class OpenClRays : public testing::Test {
 protected:
  void SetUp() override {
    if (!no_opencl().empty()) GTEST_SKIP() << no_opencl();
  }
  Random random_{test_seed()};
};

// More rays than one launch takes, and all of them on several threads at once.
TEST_F(OpenClRays, OfManyLaunchesAndThreads) {
  const Terrain terrain = cones(random_);
  std::vector<Ray> rays;
  for (int i = 0; i < 300000; ++i)
    rays.push_back(ray_at({0, 0, 50}, {uniform(random_, -4, 4), uniform(random_, -4, 4), 0}));
  const auto engine = make_opencl_engine(terrain);
  const std::vector<double> expected = ranges_of(*make_heightfield_engine(terrain), rays);
  std::vector<std::vector<double>> found(4);
  {
    std::vector<std::jthread> threads;
    for (std::vector<double>& ranges : found)
      threads.emplace_back([&] { ranges = ranges_of(*engine, rays); });
  }
  for (const std::vector<double>& ranges : found) {
    std::size_t different = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) different += same_bits(ranges[i], expected[i]) ? 0U : 1U;
    EXPECT_EQ(different, 0U);
  }
}

// A grid of more rungs than the lanes of other scenes climb, far from the site's centre.
TEST_F(OpenClRays, OnALargeGridBesideTheCentre) {
  const GridSpec spec{0.5, -300, 700, 1100, 1300};
  const Terrain terrain = terrain_of(spec, [](double x, double y) {
    return 5 * std::sin(x / 17) * std::cos(y / 23) + 0.3 * std::sin(3 * x);
  });
  const auto engine = make_opencl_engine(terrain);
  const auto expected = make_heightfield_engine(terrain);
  std::vector<Ray> rays;
  for (int i = 0; i < 50000; ++i) {
    const Eigen::Vector3d target(uniform(random_, spec.x(0), spec.x(1299)),
                                 uniform(random_, spec.y(0), spec.y(1099)), uniform(random_, -6, 6));
    const Eigen::Vector3d origin(uniform(random_, -200, 1200), uniform(random_, -200, 600),
                                 i % 3 == 0 ? 7 : 400);
    rays.push_back(ray_at(origin, target));
  }
  const std::vector<double> a = ranges_of(*engine, rays);
  const std::vector<double> b = ranges_of(*expected, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same_bits(a[i], b[i])) << i << ' ' << a[i];
}

OpenClDevice device_of(const char* name, const char* kind, const char* problem = "") {
  return {.name = name, .kind = kind, .has_doubles = true, .problem = problem};
}

TEST(OpenClDeviceChoice, PrefersTheFirstUsableGpu) {
  EXPECT_EQ(default_device({device_of("a", "cpu")}), 0U);
  EXPECT_EQ(default_device({device_of("a", "cpu"), device_of("b", "accelerator")}), 1U);
  EXPECT_EQ(default_device({device_of("a", "accelerator"), device_of("b", "gpu", "has no double precision"),
                            device_of("c", "gpu", "rounds a division"), device_of("d", "gpu"),
                            device_of("e", "gpu")}),
            3U);
  EXPECT_EQ(default_device({device_of("a", "gpu", "has no double precision"), device_of("b", "cpu")}), 1U);
}

std::string refusal_of(const std::vector<OpenClDevice>& devices) {
  try {
    static_cast<void>(default_device(devices));
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "none";
}

TEST(OpenClDeviceChoice, SaysWhyThereIsNone) {
  EXPECT_EQ(refusal_of({}), "OpenCL: there is no device, or no driver of it is installed");
  EXPECT_EQ(refusal_of({device_of("a", "gpu", "has no double precision")}),
            "OpenCL: no device can be used: a has no double precision");
  EXPECT_EQ(refusal_of({device_of("a", "gpu", "has no double precision"),
                        device_of("b", "cpu", "rounds a division")}),
            "OpenCL: no device can be used: a has no double precision, and b rounds a division");
}

TEST(OpenClDeviceUse, CountsAndKeepsTheFirstFailure) {
  DeviceUse use;
  use.count(10, 1);
  use.count(20, 2);
  use.name_device("d");
  EXPECT_FALSE(use.failure());
  use.fell_back("first");
  use.fell_back("second");
  EXPECT_EQ(use.rays(), 30U);
  EXPECT_EQ(use.undecided(), 3U);
  EXPECT_EQ(use.device(), "d");
  EXPECT_EQ(use.failure(), "first");
}

TEST_F(OpenClRays, ChosenDeviceMustExist) {
  EXPECT_THAT([&] { (void)make_opencl_engine(cones(random_), {.device = 1000}); },
              testing::ThrowsMessage<UsageError>(HasSubstr("there is no OpenCL device 1000")));
}

}  // namespace
}  // namespace landfall
