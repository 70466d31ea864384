// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include "base/core/error.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/scanner.h"
#include "chain/lidar/simulation/pulse_simulator.h"
#include "chain/lidar/simulation/simulation.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "chain/ray/flat_terrain.h"
#include "chain/terrain/relief/albedo_map.h"

namespace landfall {
namespace {

using Eigen::Vector3d;
using enum PointStatus;
using testing::Each;

const Pose kPoseAt500m{{}, {{0, 0, 500}}};
constexpr double kReference_pe = 400;  ///< at 500 m
constexpr double kPitch_rad = 1e-4;

/// Level terrain at 0, and a step of this height where x > 0.
class Step final : public TerrainSurface, public RayEngine {
 public:
  explicit Step(double height_m) : height_m_(height_m) {}
  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Vector3d& d = rays[i].direction.v;
      const double high = (height_m_ - rays[i].origin.v.z()) / d.z();
      const bool on_step = rays[i].origin.v.x() + high * d.x() > 0;
      ranges[i] = on_step ? high : -rays[i].origin.v.z() / d.z();
    }
  }
  [[nodiscard]] double elevation(double x_m, double) const override { return x_m > 0 ? height_m_ : 0; }
  [[nodiscard]] Vector3d normal(const Vector3d&) const override { return Vector3d::UnitZ(); }

 private:
  double height_m_;
};

struct Instrument {
  ReceiverParameters receiver{.type = ReceiverType::centroid, .photon_noise = false};
  int pixels = 1;
  int subpixels = 1;
  RangeErrorParameters errors{};
  RangeTimerParameters timer{};
};

Lidar lidar_of(const Instrument& instrument) {
  Detector detector = perspective_detector({.rows = 1,
                                            .columns = instrument.pixels,
                                            .field_of_view = PixelFieldOfView{kPitch_rad, kPitch_rad},
                                            .subpixels = instrument.subpixels});
  RangeTimer timer(instrument.timer, detector.pixel_count(), 1);
  Lidar lidar{.detector = std::move(detector),
              .scanner = std::make_unique<Flash>(),
              .range_errors = RangeErrors(instrument.errors, 1),
              .receiver = Receiver(instrument.receiver, 1),
              .range_timer = std::move(timer)};
  const double per_sample =
      kReference_pe * 500 * 500 / static_cast<double>(lidar.detector.samples_per_pixel());
  if (lidar.receiver.uses_waveforms())
    lidar.link_constants_pe_m2.assign(lidar.detector.samples().size(), per_sample);
  return lidar;
}

template <class Terrain>
PulseBatch simulate(const Instrument& instrument, const Terrain& terrain, const Pose& pose = kPoseAt500m,
                    const SurfaceAlbedo* albedo = nullptr) {
  const PulseSimulator simulator(lidar_of(instrument), &terrain, &terrain, albedo);
  PulseBatch batch;
  batch.resize(1, simulator.rows_per_pulse(), PointContent::all, simulator.columns());
  PulseWorkspace workspace;
  simulator.simulate({.truth = pose, .estimate = pose, .nominal = pose}, 0, batch, workspace);
  return batch;
}

/// A lander that looks along a line which meets the ground at this angle from its normal.
Pose tilted(double angle_rad, double range_m) {
  return {rotation_from<DemFrame, BodyFrame>({angle_rad, 0, 0}), {{0, 0, range_m * std::cos(angle_rad)}}};
}

TEST(ReceiverScan, WithoutAReceiverThereAreNoColumns) {
  const PulseBatch batch = simulate({.receiver = {}, .pixels = 3}, FlatTerrain());
  EXPECT_TRUE(batch.points.intensity.empty());
  EXPECT_TRUE(batch.points.return_number.empty());
  EXPECT_TRUE(batch.points.echo_signal.empty());
  EXPECT_THAT(batch.points.status, Each(returned));
}

TEST(ReceiverScan, SignalFollowsRangeAndIncidence) {
  for (const double angle_deg : {0.0, 30.0, 60.0, 80.0})
    for (const double range_m : {250.0, 500.0, 1000.0}) {
      const double angle_rad = angle_deg * std::numbers::pi / 180;
      Instrument instrument;
      instrument.receiver.threshold_pe = 1;
      const PulseBatch batch = simulate(instrument, FlatTerrain(), tilted(angle_rad, range_m));
      const double expected = kReference_pe * std::cos(angle_rad) * std::pow(500 / range_m, 2);
      EXPECT_NEAR(static_cast<double>(batch.points.intensity[0]), expected, 1e-6 * expected)
          << angle_deg << ' ' << range_m;
      EXPECT_NEAR(batch.points.range_true[0], range_m, 1e-9);
    }
}

TEST(ReceiverScan, SignalFollowsTheAlbedoOfTheNearestNode) {
  Grid<float> nodes({1, -1, -1, 3, 3}, 0.25F);
  nodes.at({1, 1}) = 0.75F;
  const AlbedoMap albedo(nodes.spec(), {3, 3}, [&](const GridSpec&) { return nodes; });
  EXPECT_FLOAT_EQ(simulate({}, FlatTerrain(), kPoseAt500m, &albedo).points.intensity[0], 300);
  const Pose beside{{}, {{0.6, 0, 500}}};
  EXPECT_FLOAT_EQ(simulate({}, FlatTerrain(), beside, &albedo).points.intensity[0], 100);
}

TEST(ReceiverScan, APixelWithoutEnoughSignalIsUndetected) {
  Instrument instrument{.errors = {.dropout_frac = 1}};
  instrument.receiver.threshold_pe = 500;
  const PulseBatch batch = simulate(instrument, FlatTerrain());
  EXPECT_EQ(batch.points.status[0], undetected);  // before a dropout
  EXPECT_TRUE(std::isnan(batch.points.range_measured[0]));
  EXPECT_TRUE(std::isnan(batch.points.intensity[0]));
  EXPECT_EQ(batch.points.range_true[0], 500);
  instrument.receiver.threshold_pe = 100;
  EXPECT_EQ(simulate(instrument, FlatTerrain()).points.status[0], dropout);
}

/// The pixel of 5 cm sees a step of 6 cm, half of it: a mixed pixel that reports the mean, while its own ray
/// is on one side.
TEST(ReceiverScan, AMixedPixelReportsBetweenItsSurfaces) {
  const Step terrain(0.06);
  const PulseBatch batch = simulate({.subpixels = 8}, terrain);
  EXPECT_NEAR(batch.points.range_measured[0], 499.97, 1e-4);
  EXPECT_NEAR(batch.points.range_true[0], 500, 1e-9);
}

TEST(ReceiverScan, FarSurfacesAreSeveralReturns) {
  const Step terrain(2);
  Instrument instrument{.pixels = 3, .subpixels = 8};
  instrument.receiver.returns = ReportedReturns::all;
  instrument.receiver.max_returns = 3;
  ConstantVelocityParameters still;
  still.position_m = {{0, 0, 500}};
  still.velocity_mps = {};
  const auto model = [&] {
    return ScanModel{.lidar = lidar_of(instrument),
                     .trajectory = std::make_unique<ConstantVelocity>(still),
                     .pulse_rate_hz = 10,
                     .scan_time_s = 0.2};
  };
  const Simulation simulation(model(), &terrain, &terrain);
  const PulseBatch batch = simulation.simulate({0, 2});
  // the middle pixel of each pulse sees both surfaces
  ASSERT_EQ(batch.points.size(), 8U);
  EXPECT_THAT(batch.pulses.point_count, Each(4));
  EXPECT_THAT(batch.points.pixel, testing::ElementsAre(0, 1, 1, 2, 0, 1, 1, 2));
  EXPECT_THAT(batch.points.return_number, testing::ElementsAre(1, 1, 2, 1, 1, 1, 2, 1));
  EXPECT_NEAR(batch.points.range_measured[1], 498, 1e-5);
  EXPECT_NEAR(batch.points.range_measured[2], 500, 1e-5);
  EXPECT_FLOAT_EQ(batch.points.intensity[1] + batch.points.intensity[2],
                  static_cast<float>(kReference_pe * 0.5 * (1 + std::pow(500.0 / 498, 2))));
  EXPECT_EQ(batch.points.range_true[2], batch.points.range_true[1]);
  EXPECT_THROW(simulation.replay({0, 1}, {std::vector<double>(3)}, *std::make_unique<PulseBatch>()),
               UsageError);
}

TEST(ReceiverScan, ADroppedPixelLosesAllItsReturns) {
  Instrument instrument{.pixels = 201, .subpixels = 8, .errors = {.dropout_frac = 0.5}};
  instrument.receiver = {.type = ReceiverType::geiger,
                         .background_pe = 20,
                         .gate_end_m = 1000,
                         .returns = ReportedReturns::all,
                         .max_returns = 3};
  const PulseBatch batch = simulate(instrument, FlatTerrain());
  int dropped = 0;
  for (std::size_t row = 0; row < batch.points.size(); row += 3) {
    const bool is_dropped = batch.points.status[row] == dropout;
    EXPECT_EQ(batch.points.return_number[row], is_dropped ? 0 : 1) << row;
    for (const std::size_t further : {row + 1, row + 2})
      EXPECT_EQ(batch.points.return_number[further] == PulseBatch::kNoSuchReturn, is_dropped) << further;
    dropped += is_dropped ? 1 : 0;
  }
  EXPECT_NEAR(dropped, 100, 30);
}

/// Ground that no ray meets.
class Sky final : public TerrainSurface, public RayEngine {
 public:
  void first_hits(std::span<const Ray>, std::span<double> ranges) const override {
    std::ranges::fill(ranges, std::nan(""));
  }
  [[nodiscard]] double elevation(double, double) const override { return 0; }
  [[nodiscard]] Vector3d normal(const Vector3d&) const override { return Vector3d::UnitZ(); }
};

/// A miss has no incidence, but the background of a Geiger-mode pixel has a range with noise.
TEST(ReceiverScan, BackgroundOfAMissHasFiniteNoise) {
  const PulseBatch batch = simulate({.receiver = {.type = ReceiverType::geiger, .background_pe = 100},
                                     .errors = {.incidence_sigma_rad = 1e-3}},
                                    Sky());
  EXPECT_THAT(batch.points.status, Each(false_return));
  EXPECT_THAT(batch.points.range_true, Each(testing::IsNan()));
  for (const auto& column : {batch.points.range_measured, batch.points.z_est, batch.points.z_true})
    EXPECT_THAT(column, Each(testing::Not(testing::IsNan())));
}

TEST(ReceiverScan, TheTimerComesLast) {
  const double step_m = 149896229 * 1e-9;
  Instrument instrument{.errors = {.range_sigma_m = 0.01}, .timer = {.timer_step_s = 1e-9}};
  const double range_m = simulate(instrument, FlatTerrain()).points.range_measured[0];
  EXPECT_NEAR(range_m / step_m, std::round(range_m / step_m), 1e-6);
}

/// The echoes that a file keeps: the echoes of pixels in order, those behind the first ones as LaterEcho.
std::vector<LaterEcho> later_echoes(const EchoColumns& rows) {
  std::vector<LaterEcho> echoes;
  for (std::size_t i = 0; i < rows.size(); ++i)
    echoes.push_back({{rows.pulse[i], rows.pixel[i], rows.number[i]},
                      {rows.signal[i], rows.peak[i], rows.edge[i], rows.width[i], rows.range[i]}});
  return echoes;
}

TEST(ReceiverScan, ReplayOfEchoesEqualsTheTrace) {
  const Step terrain(0.1);
  Instrument instrument{.receiver = {.type = ReceiverType::leading_edge},
                        .pixels = 5,
                        .subpixels = 3,
                        .errors = {.range_sigma_m = 0.01},
                        .timer = {.jitter_sigma_s = 1e-11}};
  const PulseSimulator simulator(lidar_of(instrument), &terrain, &terrain);
  OptionalColumns columns = simulator.columns();
  columns.echo = true;
  PulseBatch traced;
  traced.resize(1, 5, PointContent::all, columns);
  PulseWorkspace workspace;
  const PulseInput pulse{
      .time = {4, 0}, .truth = kPoseAt500m, .estimate = kPoseAt500m, .nominal = kPoseAt500m};
  simulator.simulate(pulse, 0, traced, workspace);
  const std::vector<Echo> echoes = workspace.received.echoes;
  PulseBatch replayed;
  replayed.resize(1, 5, PointContent::all, columns);
  PulseWorkspace fresh;
  simulator.replay(pulse, {traced.points.range_true, echoes}, 0, replayed, fresh);
  EXPECT_EQ(replayed.points, traced.points);
}

/// The bits, because a NaN does not equal itself.
void expect_same_columns(const PointColumns& found, const PointColumns& expected) {
  for_each_column(kPointColumns, [&](const auto& column) {
    const auto bytes = [&](const PointColumns& points) {
      return std::as_bytes(std::span(points.*column.rows));
    };
    EXPECT_TRUE(std::ranges::equal(bytes(found), bytes(expected))) << column.name;
  });
}

/// A pixel on a high step has two echoes near the threshold: either may be the first that is detected.
TEST(ReceiverScan, ReplayOfLaterEchoesEqualsTheTrace) {
  constexpr std::size_t kPulses = 20;
  const Step terrain(1);
  Instrument instrument{
      .receiver = {.type = ReceiverType::leading_edge, .threshold_pe = 200}, .pixels = 5, .subpixels = 4};
  const PulseSimulator simulator(lidar_of(instrument), &terrain, &terrain);
  PulseBatch traced;
  PulseBatch replayed;
  for (PulseBatch* batch : {&traced, &replayed})
    batch->resize(kPulses, 5, PointContent::all, simulator.columns(true));
  const auto pulse_at = [](std::size_t pulse) {
    return PulseInput{.time = {static_cast<std::int64_t>(pulse), 0},
                      .truth = kPoseAt500m,
                      .estimate = kPoseAt500m,
                      .nominal = kPoseAt500m};
  };
  PulseWorkspace workspace;
  std::vector<Echo> echoes;
  for (std::size_t slot = 0; slot < kPulses; ++slot) {
    simulator.simulate(pulse_at(slot), slot, traced, workspace);
    echoes.insert(echoes.end(), workspace.received.echoes.begin(), workspace.received.echoes.end());
  }
  const std::vector<LaterEcho> later = later_echoes(traced.later_echoes);
  EXPECT_EQ(later.size(), kPulses);
  const TrueRanges truth{traced.points.range_true, echoes, later};
  for (std::size_t slot = 0; slot < kPulses; ++slot)
    simulator.replay(pulse_at(slot), truth.part(5 * slot, 5), slot, replayed, workspace);
  expect_same_columns(replayed.points, traced.points);
  EXPECT_EQ(replayed.later_echoes, traced.later_echoes);
}

TEST(ReceiverScan, NeedsTheSurface) {
  const FlatTerrain terrain;
  EXPECT_THROW(PulseSimulator(lidar_of({}), &terrain, nullptr), UsageError);
}

}  // namespace
}  // namespace landfall
