// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/pulse_simulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analytic_engines.h"
#include "base/core/error.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/scanner.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "constants.h"
#include "points.h"
#include "refusal.h"

namespace landfall {
namespace {

using Eigen::Vector3d;
using enum PointStatus;
using testing::ElementsAre;

const Pose kAt500m{{}, {{0, 0, 500}}};

/// Loses pixel 1, lets pixel 2 leave 3 m beside the lidar, and blanks odd pulses.
class OddScanner : public Scanner {
 public:
  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override {
    return {.angle_1_rad = 0.25, .angle_2_rad = -0.5, .blanked = pulse.time.pulse % 2 == 1};
  }
  void steer(const ScannerState&, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override {
    for (std::size_t i = 0; i < pixels.size(); ++i) beams[i] = Beam{.direction = pixels[i], .lost = i == 1};
    if (beams.size() > 2) beams[2].exit.v.x() = 3;
  }
};

/// Aims at one point; pulse 0 only.
class OnePulse : public Pattern {
 public:
  explicit OnePulse(Vector3d target) : target_(std::move(target)) {}
  [[nodiscard]] std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const override {
    if (pulse.pulse > 0) return std::nullopt;
    return Point<DemFrame>{target_};
  }
  [[nodiscard]] std::optional<std::int64_t> pulse_limit() const override { return 1; }

 private:
  Vector3d target_;
};

/// A flat detector whose pixels look straight ahead, `columns` of them.
Detector parallel_pixels(int columns) {
  return Detector({1, columns, 1}, std::vector<Direction<LidarFrame>>(static_cast<std::size_t>(columns)), {});
}

Lidar lidar_of(Detector detector, std::unique_ptr<const Scanner> scanner,
               const RangeErrorParameters& errors = {}) {
  return Lidar{
      .detector = std::move(detector), .scanner = std::move(scanner), .range_errors = RangeErrors(errors, 1)};
}

PulseBatch simulate(const PulseSimulator& simulator, const PulseInput& pulse) {
  PulseBatch batch;
  batch.resize(1, simulator.lidar().detector.pixel_count());
  PulseWorkspace workspace;
  simulator.simulate(pulse, 0, batch, workspace);
  return batch;
}

PulseInput at(const Pose& pose, std::int64_t pulse = 0) {
  return {.time = {pulse, 0}, .truth = pose, .estimate = pose, .nominal = pose};
}

TEST(PulseSimulator, PapersDetectorSeesAnEvenGridOnFlatGround) {
  const PlaneEngine engine;
  const PulseSimulator simulator(lidar_of(perspective_detector({}), std::make_unique<Flash>()), &engine, {});
  const PulseBatch batch = simulate(simulator, at(kAt500m));
  constexpr double kGsd_m = 500 * 1.6e-3 / 18;  // 4.444 cm
  EXPECT_NEAR(kGsd_m, 0.04444, 5e-6);
  for (std::size_t i = 0; i < 324; ++i) {
    const double x = (static_cast<double>(i % 18) - 8.5) * kGsd_m;
    const double y = (8.5 - static_cast<double>(i / 18)) * kGsd_m;
    EXPECT_LT((true_point(batch, i) - Vector3d(x, y, 0)).norm(), 1e-12);
    EXPECT_NEAR(batch.points.range_true[i], std::sqrt(500 * 500 + x * x + y * y), 1e-12);
    EXPECT_EQ(estimated_point(batch, i), true_point(batch, i));
    EXPECT_EQ(batch.points.status[i], returned);
    EXPECT_EQ(batch.points.pixel[i], static_cast<int>(i));
  }
}

// Range along n from p to the plane z = z0 + g . xy: (z0 + g . p_xy - p_z) / (n_z - g . n_xy).
TEST(PulseSimulator, TiltedPlaneRangesAreClosedForm) {
  const Plane plane{3, 0.2, -0.1};
  const PlaneEngine engine(plane);
  const PulseSimulator simulator(
      lidar_of(perspective_detector({.rows = 1, .columns = 1}), std::make_unique<Flash>()), &engine, {});
  const double roll = 0.1;  // the boresight (0, 0, -1) turns to (0, sin, -cos)
  const PulseBatch batch =
      simulate(simulator, at({rotation_from<DemFrame, BodyFrame>({roll, 0, 0}), {{5, 6, 400}}}));
  const double range = (3 + 0.2 * 5 - 0.1 * 6 - 400) / (-std::cos(roll) + 0.1 * std::sin(roll));
  EXPECT_NEAR(batch.points.range_true[0], range, 1e-12);
  const Vector3d expected(5, 6 + range * std::sin(roll), 400 - range * std::cos(roll));
  EXPECT_LT((true_point(batch, 0) - expected).norm(), 1e-12);
}

// Eq. 1 with every part: body at (10, 20, 500) yawed by 90 deg, lidar 2 m along the body's x, exit 3 m along
// the lidar's x. Both point to +y_D.
TEST(PulseSimulator, MountAndExitOffsetMoveTheBeam) {
  const PlaneEngine engine;
  Lidar lidar = lidar_of(parallel_pixels(3), std::make_unique<OddScanner>());
  lidar.mount.position.v = {2, 0, -1};
  const PulseSimulator simulator(std::move(lidar), &engine, {});
  const Pose yawed{rotation_from<DemFrame, BodyFrame>({0, 0, std::numbers::pi / 2}), {{10, 20, 500}}};
  const PulseBatch batch = simulate(simulator, at(yawed));
  EXPECT_LT((true_point(batch, 0) - Vector3d(10, 22, 0)).norm(), 1e-12);
  EXPECT_LT((true_point(batch, 2) - Vector3d(10, 25, 0)).norm(), 1e-12);
  EXPECT_EQ(batch.points.range_true[2], 499);
}

// Eq. 7: position (1, -2, 3) too low in the estimate, roll of 0.01 rad applied, range 0.5 m too long. The
// estimated ray leaves (-1, 2, 497) along Rx(0.01) (0, 0, -1) = (0, sin, -cos).
TEST(PulseSimulator, EstimateUsesMeasuredRangeAndEstimatedPose) {
  const PlaneEngine engine;
  const PulseSimulator simulator(
      lidar_of(parallel_pixels(1), std::make_unique<Flash>(), {.range_bias_m = 0.5}), &engine, {});
  PulseInput pulse = at(kAt500m);
  pulse.estimate = {rotation_from<DemFrame, BodyFrame>({0.01, 0, 0}), {{-1, 2, 497}}};
  const PulseBatch batch = simulate(simulator, pulse);
  EXPECT_EQ(batch.points.range_true[0], 500);
  EXPECT_EQ(batch.points.range_measured[0], 500.5);
  EXPECT_LT(true_point(batch, 0).norm(), 1e-12);
  const Vector3d expected(-1, 2 + 500.5 * std::sin(0.01), 497 - 500.5 * std::cos(0.01));
  EXPECT_LT((estimated_point(batch, 0) - expected).norm(), 1e-12);
}

TEST(PulseSimulator, AimsFromTheNominalPose) {
  const PlaneEngine engine;
  Lidar lidar = lidar_of(parallel_pixels(1), std::make_unique<Fsm>(FsmParameters{}));
  lidar.pattern = std::make_unique<OnePulse>(Vector3d(30, -40, 0));
  const PulseSimulator simulator(std::move(lidar), &engine, {});
  PulseInput pulse = at(kAt500m);
  EXPECT_LT((true_point(simulate(simulator, pulse), 0) - Vector3d(30, -40, 0)).norm(), 1e-12);
  pulse.truth.position.v = {0, 1, 250};  // the same angles from elsewhere
  EXPECT_LT((true_point(simulate(simulator, pulse), 0) - Vector3d(15, -19, 0)).norm(), 1e-12);
}

TEST(PulseSimulator, PulseTableHoldsStateAndPoses) {
  const PlaneEngine engine;
  const PulseSimulator simulator(lidar_of(parallel_pixels(1), std::make_unique<OddScanner>()), &engine, {});
  PulseInput pulse = at({rotation_from<DemFrame, BodyFrame>({0, 0, std::numbers::pi / 2}), {{1, 2, 3}}});
  pulse.t_s = 7.5;
  // 240 deg about x: cos 120 deg < 0, so that the quaternion's sign must be turned.
  pulse.estimate = {rotation_from<DemFrame, BodyFrame>({4 * std::numbers::pi / 3, 0, 0}), {{4, 5, 6}}};
  const PulseColumns out = simulate(simulator, pulse).pulses;
  EXPECT_EQ(out.t[0], 7.5);
  EXPECT_EQ(out.angle_1[0], 0.25);
  EXPECT_EQ(out.angle_2[0], -0.5);
  EXPECT_EQ(Vector3d(out.px_true[0], out.py_true[0], out.pz_true[0]), Vector3d(1, 2, 3));
  EXPECT_EQ(Vector3d(out.px_est[0], out.py_est[0], out.pz_est[0]), Vector3d(4, 5, 6));
  const double h = std::sqrt(0.5);
  EXPECT_NEAR(out.qw_true[0], h, 1e-15);
  EXPECT_NEAR(out.qx_true[0], 0, 1e-15);
  EXPECT_NEAR(out.qy_true[0], 0, 1e-15);
  EXPECT_NEAR(out.qz_true[0], h, 1e-15);
  EXPECT_NEAR(out.qw_est[0], 0.5, 1e-15);
  EXPECT_NEAR(out.qx_est[0], -std::sqrt(0.75), 1e-15);
  EXPECT_EQ(out.point_count[0], 1);
}

/// The statuses of three pixels, of which OddScanner loses the second, at a pulse.
std::vector<PointStatus> statuses(const RangeErrorParameters& errors, const RayEngine& engine,
                                  std::int64_t pulse) {
  const PulseSimulator simulator(lidar_of(parallel_pixels(3), std::make_unique<OddScanner>(), errors),
                                 &engine, {});
  return simulate(simulator, at(kAt500m, pulse)).points.status;
}

TEST(PulseSimulator, FirstStatusThatAppliesWins) {
  const PlaneEngine terrain;
  const PlaneEngine sky({.z0_m = 1000});
  const RangeErrorParameters drop_all{.dropout_frac = 1};
  const RangeErrorParameters all_dead{.dead_pixel_frac = 1, .dropout_frac = 1};
  EXPECT_THAT(statuses({}, terrain, 0), ElementsAre(returned, lost_in_optics, returned));
  EXPECT_THAT(statuses(drop_all, terrain, 0), ElementsAre(dropout, lost_in_optics, dropout));
  EXPECT_THAT(statuses(drop_all, sky, 0), ElementsAre(miss, lost_in_optics, miss));
  EXPECT_THAT(statuses(drop_all, terrain, 1), ElementsAre(blanked, blanked, blanked));
  EXPECT_THAT(statuses(all_dead, terrain, 1), ElementsAre(dead, dead, dead));
  EXPECT_THAT(statuses(all_dead, sky, 0), ElementsAre(dead, dead, dead));
}

// Dead pixels and dropouts were traced: what they would have seen is kept; nothing is measured.
TEST(PulseSimulator, TruthSurvivesDropoutAndDeath) {
  const PlaneEngine engine;
  for (const RangeErrorParameters& errors :
       {RangeErrorParameters{.dropout_frac = 1}, RangeErrorParameters{.dead_pixel_frac = 1}}) {
    const PulseSimulator simulator(lidar_of(parallel_pixels(1), std::make_unique<Flash>(), errors), &engine,
                                   {});
    const PulseBatch batch = simulate(simulator, at(kAt500m));
    EXPECT_EQ(batch.points.range_true[0], 500);
    EXPECT_EQ(true_point(batch, 0), Vector3d(0, 0, 0));
    EXPECT_TRUE(std::isnan(batch.points.range_measured[0]));
    EXPECT_TRUE(estimated_point(batch, 0).array().isNaN().all());
  }
}

TEST(PulseSimulator, MissBlankAndLostLeaveNothing) {
  const PlaneEngine terrain;
  const PlaneEngine sky({.z0_m = 1000});
  const auto nothing_of = [](const RayEngine& engine, std::int64_t pulse, std::size_t pixel) {
    const PulseSimulator simulator(lidar_of(parallel_pixels(3), std::make_unique<OddScanner>()), &engine, {});
    const PulseBatch batch = simulate(simulator, at(kAt500m, pulse));
    EXPECT_TRUE(std::isnan(batch.points.range_true[pixel]));
    EXPECT_TRUE(std::isnan(batch.points.range_measured[pixel]));
    EXPECT_TRUE(true_point(batch, pixel).array().isNaN().all());
    EXPECT_TRUE(estimated_point(batch, pixel).array().isNaN().all());
  };
  nothing_of(sky, 0, 0);      // miss
  nothing_of(terrain, 0, 1);  // total reflection
  nothing_of(terrain, 1, 0);  // blanked
}

TEST(PulseSimulator, PulseThatThePatternLeavesOutIsBlanked) {
  const RecordingEngine engine;
  Lidar lidar = lidar_of(parallel_pixels(1), std::make_unique<Fsm>(FsmParameters{}));
  lidar.pattern = std::make_unique<OnePulse>(Vector3d(0, 0, 0));
  const PulseSimulator simulator(std::move(lidar), &engine, {});
  EXPECT_EQ(simulate(simulator, at(kAt500m, 0)).points.status[0], returned);
  EXPECT_EQ(simulate(simulator, at(kAt500m, 1)).points.status[0], blanked);
  EXPECT_EQ(engine.calls.size(), 1U) << "what is not fired is not traced";
}

TEST(PulseSimulator, OneCallPerPulseWithoutLostBeams) {
  const RecordingEngine engine;
  const PulseSimulator simulator(lidar_of(parallel_pixels(3), std::make_unique<OddScanner>()), &engine, {});
  simulate(simulator, at(kAt500m));
  ASSERT_EQ(engine.calls.size(), 1U);
  ASSERT_EQ(engine.calls[0].size(), 2U);
  EXPECT_EQ(engine.calls[0][0].origin.v.x(), 0);
  EXPECT_EQ(engine.calls[0][1].origin.v.x(), 3);
}

/// One pixel, 2 x 2 sub-pixels, 0.1 rad wide, 500 m high, over the ground's edge: its sub-pixels meet z = 0
/// at x = -12.5 and +12.5 m, twice each.
PulseBatch at_edge(const RayEngine& engine) {
  const PulseSimulator simulator(
      lidar_of(perspective_detector(
                   {.rows = 1, .columns = 1, .field_of_view = PixelFieldOfView{0.1, 0.1}, .subpixels = 2}),
               std::make_unique<Flash>()),
      &engine, {});
  return simulate(simulator, at(kAt500m));
}

TEST(PulseSimulator, SubpixelsAverageOverAnEdge) {
  const PulseBatch batch = at_edge(EdgeEngine(0, 10));
  const double stretch = std::sqrt(1 + 2 * 0.025 * 0.025);  // of every sub-pixel's ray
  EXPECT_NEAR(batch.points.range_true[0], 495 * stretch, 1e-12);
  // On the centre ray, straight down, wherever that meets the terrain itself.
  EXPECT_LT((true_point(batch, 0) - Vector3d(0, 0, 500 - 495 * stretch)).norm(), 1e-12);
}

TEST(PulseSimulator, AsksTheDetectorsEstimator) {
  PerspectiveParameters pixel{
      .rows = 1, .columns = 1, .field_of_view = PixelFieldOfView{0.1, 0.1}, .subpixels = 2};
  pixel.estimator.rule = RangeRule::first;
  const EdgeEngine engine(0, 10);
  const PulseSimulator simulator(lidar_of(perspective_detector(pixel), std::make_unique<Flash>()), &engine,
                                 {});
  const PulseBatch batch = simulate(simulator, at(kAt500m));
  EXPECT_NEAR(batch.points.range_true[0], 490 * std::sqrt(1 + 2 * 0.025 * 0.025), 1e-12);
}

TEST(PulseSimulator, HalfOfTheSubpixelsAreAReturn) {
  const PulseBatch batch = at_edge(EdgeEngine(0));
  EXPECT_EQ(batch.points.status[0], returned);
  EXPECT_NEAR(batch.points.range_true[0], 500 * std::sqrt(1 + 2 * 0.025 * 0.025), 1e-12);
  EXPECT_EQ(at_edge(EdgeEngine(13)).points.status[0], miss);
}

// OddScanner loses the second ray of whatever it steers: one sub-pixel of pixel 0, and the centre ray of
// pixel 1, on which its point would lie.
TEST(PulseSimulator, LostSubpixelIsAMissLostCentreIsTheEnd) {
  const PlaneEngine engine;
  const PulseSimulator simulator(lidar_of(perspective_detector({.rows = 1, .columns = 2, .subpixels = 2}),
                                          std::make_unique<OddScanner>()),
                                 &engine, {});
  const PulseBatch batch = simulate(simulator, at(kAt500m));
  EXPECT_THAT(batch.points.status, ElementsAre(returned, lost_in_optics));
  EXPECT_NEAR(batch.points.range_true[0], 500, 1e-5);
  EXPECT_TRUE(std::isnan(batch.points.range_true[1]));
}

TEST(PulseSimulator, SubpixelsShareTheirPulsesCall) {
  const RecordingEngine engine;
  at_edge(engine);
  ASSERT_EQ(engine.calls.size(), 1U);
  EXPECT_EQ(engine.calls[0].size(), 4U);
}

TEST(PulseSimulator, ReplayRedrawsOnlyTheErrors) {
  const PlaneEngine engine;
  const PulseSimulator simulator(lidar_of(perspective_detector({.rows = 3, .columns = 3}),
                                          std::make_unique<Flash>(), {.range_sigma_m = 0.1}),
                                 &engine, {});
  PulseBatch traced = simulate(simulator, at(kAt500m, 4));
  PulseBatch replayed;
  replayed.resize(1, 9);
  PulseWorkspace workspace;
  simulator.replay(at(kAt500m, 4), {traced.points.range_true}, 0, replayed, workspace);
  EXPECT_EQ(replayed.points, traced.points);
  EXPECT_EQ(replayed.pulses, traced.pulses);
  traced.points.range_true[5] = kNan;
  simulator.replay(at(kAt500m, 4), {traced.points.range_true}, 0, replayed, workspace);
  EXPECT_EQ(replayed.points.status[5], miss);
}

class OverAMound : public testing::Test {
 protected:
  /// 3 x 3 nodes at -10, 0, 10 m; the middle one is 8 m high.
  static TriangulatedGrid mound() {
    Grid<double> nodes(GridSpec::centered(10, 10));
    nodes.at({1, 1}) = 8;
    return TriangulatedGrid(std::move(nodes));
  }
  void fire(const Vector3d& position) {
    const PulseSimulator simulator(lidar_of(parallel_pixels(1), std::make_unique<Flash>()), &engine_,
                                   &terrain_);
    simulate(simulator, at({{}, {position}}, 17));
  }
  PlaneEngine engine_;
  TriangulatedGrid terrain_ = mound();
};

TEST_F(OverAMound, RefusesALidarAtOrBelowTheGround) {
  EXPECT_NO_THROW(fire({0, 0, 8.001}));
  EXPECT_THROW(fire({0, 0, 8}), FormatError);
  EXPECT_NO_THROW(fire({10.001, 0, -5})) << "off the grid there is no terrain";
  EXPECT_THAT(refusal<FormatError>([&] {
                fire({5, 0, 3.5});
              }),
              testing::AllOf(testing::HasSubstr("pulse 17"),
                             testing::HasSubstr("3.5 m high, at or below the terrain, 4 m")));
}

// Pixel 2 leaves 3 m beside the lidar, where the ground is higher than the beam.
TEST_F(OverAMound, LooksAtEveryBeamsOrigin) {
  const PulseSimulator simulator(lidar_of(parallel_pixels(3), std::make_unique<OddScanner>()), &engine_,
                                 &terrain_);
  EXPECT_NO_THROW(simulate(simulator, at({{}, {{1, 0, 7.5}}})));
  EXPECT_THROW(simulate(simulator, at({{}, {{-4, 0, 7}}})), FormatError);
}

/// Aims at (k, 0, 0) by pulse k = 0 .. 5, every third of which begins a new line.
class Steps : public Pattern {
 public:
  [[nodiscard]] std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const override {
    if (pulse.pulse > 5) return std::nullopt;
    return Point<DemFrame>{{static_cast<double>(pulse.pulse), 0, 0}};
  }
  [[nodiscard]] std::optional<PatternJump> last_jump(const PulseTime& pulse) const override {
    if (pulse.pulse < 3) return std::nullopt;
    return PatternJump{0.1 * static_cast<double>(pulse.pulse - 3), {2, 0}};
  }
};

/// Looks straight ahead and keeps what it was told.
class Listener : public Flash {
 public:
  Listener(ContextNeeds needs, PulseContext& received) : needs_(needs), received_(&received) {}
  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override {
    *received_ = pulse;
    return {};
  }
  [[nodiscard]] ContextNeeds needs() const override { return needs_; }

 private:
  ContextNeeds needs_;
  PulseContext* received_;
};

PulseContext received_at(std::int64_t pulse, ContextNeeds needs, double interval_s) {
  PulseContext received;
  Lidar lidar = lidar_of(parallel_pixels(1), std::make_unique<Listener>(needs, received));
  lidar.pattern = std::make_unique<Steps>();
  const PlaneEngine engine;
  const PulseSimulator simulator(std::move(lidar), &engine, {});
  PulseInput input = at(kAt500m, pulse);
  input.interval_s = interval_s;
  static_cast<void>(simulate(simulator, input));
  return received;
}

/// The point in D at which an aim from 500 m meets z = 0.
double terrain_x(const Direction<LidarFrame>& aim) { return 500 * aim.v.x() / aim.v.z(); }

TEST(PulseSimulator, AScannerHearsOfJumpsAndEchoesOnlyIfItAsks) {
  const PulseContext plain = received_at(4, {}, 1e-6);
  EXPECT_NEAR(terrain_x(*plain.aim), 4, 1e-12);
  EXPECT_EQ(plain.since_jump_s, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(plain.aim_before_jump || plain.aim_at_echo);
  const PulseContext jumped = received_at(4, {.jumps = true}, 1e-6);
  EXPECT_DOUBLE_EQ(jumped.since_jump_s, 0.1);
  EXPECT_NEAR(terrain_x(*jumped.aim_before_jump), 2, 1e-12);
  EXPECT_FALSE(received_at(2, {.jumps = true}, 1e-6).aim_before_jump);
}

// From (0, 0, 500) the echo of (2, 0, 0) takes 2 sqrt(500^2 + 2^2)/c = 3.3357 us; a pulse every 3 us moves
// the aim 1 m.
TEST(PulseSimulator, TheAimAtTheEchoMovesEvenlyBetweenPulses) {
  const double flight_s = 2 * std::sqrt(500.0 * 500 + 4) / 299792458;
  EXPECT_NEAR(terrain_x(*received_at(2, {.echo = true}, 3e-6).aim_at_echo), 2 + flight_s / 3e-6, 1e-9);
  EXPECT_NEAR(terrain_x(*received_at(2, {.echo = true}, 1).aim_at_echo), 2 + flight_s, 1e-9);
  EXPECT_NEAR(terrain_x(*received_at(2, {.echo = true}, 0).aim_at_echo), 2, 1e-12);
}

// Pulse 5 is the last with an aim, pulse 2 the last before a jump, and no aim comes before pulse 0.
TEST(PulseSimulator, TheAimAtTheEchoCarriesOnOverJumpsAndEnds) {
  const auto flight_s = [](double x) { return 2 * std::sqrt(500.0 * 500 + x * x) / 299792458; };
  EXPECT_NEAR(terrain_x(*received_at(4, {.echo = true}, 1e-6).aim_at_echo), 4 + flight_s(4) / 1e-6, 1e-9);
  EXPECT_NEAR(terrain_x(*received_at(5, {.echo = true}, 1e-5).aim_at_echo), 5 + flight_s(5) / 1e-5, 1e-9);
  EXPECT_NEAR(terrain_x(*received_at(2, {.echo = true}, 1e-5).aim_at_echo), 2 + flight_s(2) / 1e-5, 1e-9);
  EXPECT_NEAR(terrain_x(*received_at(0, {.echo = true}, 1e-6).aim_at_echo), flight_s(0) / 1e-6, 1e-9);
}

/// Leans its beams by angle_1 to +x; the lander believes twice as much.
class Leaning : public Scanner {
 public:
  explicit Leaning(double angle_rad) : angle_rad_(angle_rad) {}
  [[nodiscard]] ScannerState state(const PulseContext&) const override { return {.angle_1_rad = angle_rad_}; }
  [[nodiscard]] bool is_known() const override { return false; }
  [[nodiscard]] ScannerState estimated_state(const PulseContext&, const ScannerState& truth) const override {
    return {.angle_1_rad = 2 * truth.angle_1_rad};
  }
  void steer(const ScannerState& state, std::span<const Direction<LidarFrame>>,
             std::span<Beam> beams) const override {
    for (Beam& beam : beams)
      beam = {.direction = {{std::sin(state.angle_1_rad), 0, std::cos(state.angle_1_rad)}},
              .lost = state.angle_1_rad > 1};
  }

 private:
  double angle_rad_;
};

TEST(PulseSimulator, TheEstimateUsesTheBelievedState) {
  const PlaneEngine engine;
  const PulseSimulator simulator(lidar_of(parallel_pixels(1), std::make_unique<Leaning>(0.25)), &engine, {});
  const PulseBatch batch = simulate(simulator, at(kAt500m));
  const double range = 500 / std::cos(0.25);
  EXPECT_LT((true_point(batch, 0) - Vector3d(500 * std::tan(0.25), 0, 0)).norm(), 1e-10);
  const Vector3d estimated(range * std::sin(0.5), 0, 500 - range * std::cos(0.5));
  EXPECT_LT((estimated_point(batch, 0) - estimated).norm(), 1e-10);
  EXPECT_EQ(batch.pulses.angle_1[0], 0.25);
}

TEST(PulseSimulator, ABeamThatIsLostToTheLanderIsLost) {
  const PlaneEngine engine;
  const PulseSimulator simulator(lidar_of(parallel_pixels(1), std::make_unique<Leaning>(0.75)), &engine, {});
  EXPECT_EQ(simulate(simulator, at(kAt500m)).points.status[0], lost_in_optics);
}

}  // namespace
}  // namespace landfall
