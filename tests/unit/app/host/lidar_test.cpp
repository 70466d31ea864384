// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/host/lidar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "constants.h"
#include "refusal.h"

namespace landfall::lidar {
namespace {

using testing::HasSubstr;

const std::string kFlash =
    R"({"detector": {"rows": 1, "columns": 3, "ifov_rad": 0.1}, "scanner": {"type": "flash"}})";

double plane(const Ray& ray) { return -ray.origin_m[2] / ray.direction[2]; }

Instrument instrument(const std::string& config) { return {config, plane}; }

template <class Work>
std::string lidar_refusal(const Work& work) {
  return refusal<std::runtime_error>([&] { work(); });
}

const Pose kAt10m{.position_m = {1, 2, 10}};

TEST(Instrument, LooksDownFromWhereTheHostSays) {
  const PulseReturns returns = instrument(kFlash).step({.truth = kAt10m});
  ASSERT_EQ(returns.pixels.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const PixelReturn& pixel = returns.pixels[i];
    EXPECT_EQ(pixel.pixel, static_cast<int>(i));
    EXPECT_EQ(pixel.status, Status::returned);
    EXPECT_NEAR(pixel.true_m[0], static_cast<double>(i), 1e-14);
    EXPECT_NEAR(pixel.true_m[1], 2, 1e-14);
    EXPECT_NEAR(pixel.true_m[2], 0, 1e-14);
    EXPECT_EQ(pixel.estimated_m, pixel.true_m);
  }
  EXPECT_EQ(returns.pixels[1].range_true_m, 10);
}

// A quarter turn about z_B takes what looked to -x_D to -y_D.
TEST(Instrument, AttitudeIsBodyToMapScalarFirst) {
  const double half = std::numbers::sqrt2 / 2;
  const PulseReturns returns =
      instrument(kFlash).step({.truth = {.position_m = {1, 2, 10}, .attitude = {half, 0, 0, half}}});
  EXPECT_NEAR(returns.pixels[0].true_m[0], 1, 1e-14);
  EXPECT_NEAR(returns.pixels[0].true_m[1], 1, 1e-14);
}

TEST(Instrument, TheHostsEstimateMovesOnlyTheEstimate) {
  const PulseReturns returns =
      instrument(kFlash).step({.truth = kAt10m, .estimate = Pose{.position_m = {1.5, 2, 10.25}}});
  EXPECT_NEAR(returns.pixels[1].true_m[0], 1, 1e-14);
  EXPECT_NEAR(returns.pixels[1].estimated_m[0], 1.5, 1e-14);
  EXPECT_NEAR(returns.pixels[1].estimated_m[2], 0.25, 1e-14);
}

TEST(Instrument, WithoutOneTheConfigurationsNavigationErrorIsSubtracted) {
  const Instrument lidar = instrument(R"({"detector": {"rows": 1, "columns": 1}, "scanner": {"type": "flash"},
      "laser": {"pulse_rate_hz": 10}, "navigation_error": {"position_m": [0, 0, 1], "velocity_mps": [2, 0, 0]}})");
  EXPECT_EQ(lidar.pulse_rate_hz(), 10);
  const PulseReturns returns = lidar.step({.number = 5, .truth = kAt10m});
  EXPECT_NEAR(returns.pixels[0].estimated_m[0], 0, 1e-14);
  EXPECT_NEAR(returns.pixels[0].estimated_m[2], -1, 1e-14);
  const PulseReturns later = lidar.step({.number = 5, .truth = kAt10m, .since_start_s = 1.0});
  EXPECT_NEAR(later.pixels[0].estimated_m[0], -1, 1e-14);
}

TEST(Instrument, AMissIsNanInfiniteOrNegative) {
  for (const double miss : {kNan, std::numeric_limits<double>::infinity(), -1.0}) {
    const Instrument lidar(kFlash, [&](const Ray& ray) { return ray.direction[0] > 0.05 ? miss : 7.0; });
    const PulseReturns returns = lidar.step({.truth = kAt10m});
    EXPECT_EQ(returns.pixels[0].range_true_m, 7);
    EXPECT_EQ(returns.pixels[2].status, Status::miss);
    EXPECT_TRUE(std::isnan(returns.pixels[2].range_true_m));
    EXPECT_TRUE(std::isnan(returns.pixels[2].estimated_m[0]));
  }
}

TEST(Instrument, ABatchCallbackGetsAPulseAtOnce) {
  std::vector<std::size_t> calls;
  const Instrument lidar(kFlash, [&](std::span<const Ray> rays, std::span<double> ranges_m) {
    calls.push_back(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) ranges_m[i] = plane(rays[i]);
  });
  EXPECT_EQ(lidar.step({.truth = kAt10m}).pixels[1].range_true_m, 10);
  EXPECT_EQ(calls, std::vector<std::size_t>{3});
}

TEST(Instrument, AnUncompensatedPatternNeedsItsNominalPose) {
  const auto lidar = instrument(R"({"detector": {"rows": 1, "columns": 1}, "scanner": {"type": "fsm",
      "pattern": {"type": "line_search", "rows": 1, "columns": 2, "half_width_m": 1, "compensated": false,
                  "at_end": "stop"}}})");
  EXPECT_EQ(lidar.pulse_limit(), 2);
  EXPECT_THAT(lidar_refusal([&] { return lidar.step({.truth = kAt10m}); }), HasSubstr("pulse/nominal"));
  const Pose start{.position_m = {0, 0, 20}};
  // Aimed at (-1, 0) from 20 m, seen from 10 m: half as far.
  EXPECT_NEAR(lidar.step({.truth = {.position_m = {0, 0, 10}}, .nominal = start}).pixels[0].true_m[0], -0.5,
              1e-14);
}

TEST(Instrument, TablesComeFromTheHost) {
  const std::string config = R"({"detector": {"rows": 1, "columns": 1, "distribution": {"path": "p"}},
      "scanner": {"type": "flash"}, "trajectory": {"type": "table", "path": "never read"}})";
  const auto read = [](const std::string& path) -> std::map<std::string, std::vector<double>> {
    EXPECT_EQ(path, "p");
    return {{"row", {0}}, {"column", {0}}, {"u", {0.5}}, {"v", {0}}};
  };
  EXPECT_NEAR(Instrument(config, plane, "c", read).step({.truth = kAt10m}).pixels[0].true_m[0], 6, 1e-14);
  EXPECT_THAT(lidar_refusal([&] { Instrument(config, plane, "c"); }), HasSubstr("reads no tables"));
  EXPECT_THAT(lidar_refusal([&] {
                Instrument(config, plane, "c", [](const std::string&) {
                  return std::map<std::string, std::vector<double>>{{"row", {0}}};
                });
              }),
              HasSubstr("p: no column column"));
}

TEST(Instrument, RefusesWhatIsWrongByName) {
  EXPECT_THAT(lidar_refusal([] { Instrument("{", plane, "my.json"); }), HasSubstr("my.json: not valid JSON"));
  EXPECT_THAT(lidar_refusal([] { Instrument("[]", plane, "my.json"); }), HasSubstr("my.json: "));
  EXPECT_THAT(lidar_refusal([] { Instrument(R"({"detector": {"rows": 0}})", plane, "my.json"); }),
              HasSubstr("my.json: /detector/rows: 0"));
  EXPECT_THAT(lidar_refusal([] { Instrument("{}", Intersect()); }), HasSubstr("intersect"));
  EXPECT_THAT(lidar_refusal([] { Instrument("{}", IntersectAll()); }), HasSubstr("intersect"));
  const Instrument lidar = instrument(kFlash);
  const auto refused = [&](const Pulse& pulse) { return lidar_refusal([&] { return lidar.step(pulse); }); };
  EXPECT_THAT(refused({.number = -1}), HasSubstr("pulse/number: -1"));
  EXPECT_THAT(refused({.number = std::int64_t{1} << 31}), HasSubstr("pulse/number"));
  EXPECT_THAT(refused({.since_start_s = kNan}), HasSubstr("pulse/since_start_s"));
  EXPECT_THAT(refused({.truth = {.position_m = {0, kNan, 0}}}), HasSubstr("pulse/truth/position_m"));
  EXPECT_THAT(refused({.estimate = Pose{.attitude = {1, 1, 0, 0}}}), HasSubstr("pulse/estimate/attitude"));
  EXPECT_THAT(refused({.nominal = Pose{.attitude = {kNan, 0, 0, 0}}}), HasSubstr("pulse/nominal/attitude"));
}

TEST(Instrument, RefusesErrorsThatAreTheHosts) {
  const std::map<std::string, std::string> key_of = {
      {R"({"navigation_error": {"table": "a.csv"}})", "/navigation_error/table"},
      {R"({"navigation_error": {"attitude": "commanded"}})", "/navigation_error/attitude"},
      {R"({"pointing_error": {"time_stamp_bias_s": 0.1}})", "/pointing_error/time_stamp_bias_s"},
      {R"({"pointing_error": {"time_stamp_sigma_s": 0.1}})", "/pointing_error/time_stamp_sigma_s"},
      {R"({"noise": {"incidence_sigma_rad": 0.1}})", "noise/incidence_sigma_rad"},
      {R"({"receiver": {"type": "peak"}, "link": {"reference_pe": 100, "reference_range_m": 10}})",
       "/receiver/type"}};
  for (const auto& entry : key_of)
    EXPECT_THAT(lidar_refusal([&] { Instrument(entry.first, plane, "c"); }), HasSubstr(entry.second));
}

TEST(Instrument, HasTheClockOfAReceiver) {
  const Instrument lidar =
      instrument(R"({"scanner": {"type": "flash"}, "receiver": {"timer_step_s": 1e-9}})");
  const double step_m = 299792458.0 / 2 * 1e-9;
  const PulseReturns returns = lidar.step({.truth = kAt10m});
  for (const PixelReturn& pixel : returns.pixels) {
    EXPECT_DOUBLE_EQ(pixel.range_measured_m, step_m * std::floor(pixel.range_true_m / step_m + 0.5));
    EXPECT_NE(pixel.range_measured_m, pixel.range_true_m);
  }
}

TEST(Instrument, MemoryIsUsedAgain) {
  const Instrument lidar = instrument(kFlash);
  PulseReturns returns;
  lidar.step({.truth = kAt10m}, returns);
  const PixelReturn* const before = returns.pixels.data();
  lidar.step({.number = 1, .truth = kAt10m}, returns);
  EXPECT_EQ(returns.pixels.data(), before);
}

}  // namespace
}  // namespace landfall::lidar
