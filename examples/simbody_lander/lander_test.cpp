// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of the model, the filter and the scene against closed forms. tests/chain/simbody_test.py runs them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include "flight.h"
#include "heightfield.h"
#include "lidar_host.h"

namespace lander {
namespace {

constexpr double kPi = std::numbers::pi;
const Flight::Altimeter kNoGround = [](const Vector3d&, const Vector3d&) {
  return std::numeric_limits<double>::quiet_NaN();
};

Design without_damping() {
  Design design;
  design.legs.damping_ratio = design.tanks.damping_ratio = 0;
  return design;
}

struct Totals {
  double mass_kg = 0, kinetic_j = 0;
  Vector3d centre_m{0, 0, 0}, momentum{0, 0, 0}, angular{0, 0, 0};  ///< the last about the centre of mass
};

Totals totals_of(const std::vector<BodyMotion>& bodies) {
  Totals all;
  for (const BodyMotion& body : bodies) {
    all.mass_kg += body.mass_kg;
    all.centre_m += body.mass_kg * body.centre_m;
    all.momentum += body.mass_kg * body.velocity_mps;
    all.kinetic_j += body.mass_kg * body.velocity_mps.squaredNorm() / 2 +
                     body.rate_radps.dot(body.inertia_kgm2 * body.rate_radps) / 2;
    all.angular +=
        body.inertia_kgm2 * body.rate_radps + body.mass_kg * body.centre_m.cross(body.velocity_mps);
  }
  all.centre_m /= all.mass_kg;
  all.angular -= all.centre_m.cross(all.momentum);
  return all;
}

double spring_energy_j(const Design& design, const std::vector<double>& legs_rad) {
  const double inertia = design.legs.mass_kg * design.legs.length_m * design.legs.length_m / 3;
  const double stiffness = inertia * std::pow(2 * kPi * design.legs.frequency_hz, 2);
  double energy = 0;
  for (const double angle : legs_rad) energy += stiffness * angle * angle / 2;
  return energy;
}

/// A tumbling start in which every joint moves; slow, because in free fall the pendulums keep turning.
const Start kTumble{{{1, 2, 300}, {3, -4, 5}, rotation({0.3, -0.2, 0.5}), {0.03, -0.04, 0.02}},
                    {{0.5, -0.3}, {0.2, 0.6}},
                    0.05};

TEST(Lander, FreeFallConservesMomentumAndEnergy) {
  const Design design = without_damping();
  Lander lander(design, kTumble);
  const Totals before = totals_of(lander.bodies());
  const double springs = spring_energy_j(design, lander.legs_rad()), g = design.gravity_mps2;
  EXPECT_NEAR(before.mass_kg, design.total_kg(), 1e-9);
  const std::vector<Vector2d> first = lander.slosh_rad();
  for (const double t : {1.0, 3.7, 9.0}) {
    lander.advance_to(t);
    EXPECT_EQ(lander.t_s(), t);
    const Totals now = totals_of(lander.bodies());
    const Vector3d fall(0, 0, -g * t * t / 2), speed(0, 0, -g * t);
    const Vector3d velocity = before.momentum / before.mass_kg;
    EXPECT_LT((now.centre_m - (before.centre_m + velocity * t + fall)).norm(), 1e-7);
    EXPECT_LT((now.momentum / now.mass_kg - velocity - speed).norm(), 1e-8);
    EXPECT_LT((now.angular - before.angular).norm(), 1e-7 * before.angular.norm());
    const double gained = before.mass_kg * g * (before.centre_m.z() - now.centre_m.z());
    EXPECT_NEAR(now.kinetic_j + spring_energy_j(design, lander.legs_rad()),
                before.kinetic_j + springs + gained, 1e-6 * (before.kinetic_j + springs));
  }
  EXPECT_GT((lander.slosh_rad()[0] - first[0]).norm(), 0.1);
}

TEST(Lander, DampersOnlyLoseEnergy) {
  const Design design;
  Lander lander(design, kTumble);
  const Totals before = totals_of(lander.bodies());
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step <= 10; ++step) {
    lander.advance_to(0.5 * step);
    const Totals now = totals_of(lander.bodies());
    const double energy = now.kinetic_j + spring_energy_j(design, lander.legs_rad()) +
                          now.mass_kg * design.gravity_mps2 * now.centre_m.z();
    EXPECT_LT(energy, last);
    last = energy;
    EXPECT_LT((now.angular - before.angular).norm(), 1e-7 * before.angular.norm());
  }
}

TEST(Lander, ForceAndTorqueTurnWithTheBus) {
  Start start;
  start.bus.attitude = rotation({kPi / 2, 0, 0});  // y_B along z_D, z_B along -y_D
  Lander lander(Design(), start);
  const Totals before = totals_of(lander.bodies());
  const double t = 0.1, thrust = 5e-4, torque = 1e-3;
  lander.set({thrust, {0, 0, torque}});
  lander.advance_to(t);
  const Totals now = totals_of(lander.bodies());
  const Vector3d weight(0, 0, -now.mass_kg * Design().gravity_mps2);
  EXPECT_LT((now.momentum - before.momentum - (Vector3d(0, -thrust, 0) + weight) * t).norm(), 1e-7);
  // The thrust passes through the bus's origin, not through the centre of mass of all.
  const Vector3d lever = start.bus.position_m - before.centre_m;
  const Vector3d moment = Vector3d(0, -torque, 0) + lever.cross(Vector3d(0, -thrust, 0));
  EXPECT_LT((now.angular - before.angular - moment * t).norm(), 1e-3 * torque * t);
}

TEST(Lander, SloshMassAndRodOfACylindricalTank) {
  // R = 0.4 m, h = 0.5 m: tanh(1.8412 h / R) = 0.98016; 150 kg * 0.8 / 2.2 * 0.98016; 0.4 m / (1.8412 *
  // 0.98016)
  EXPECT_NEAR(Design().slosh_kg(), 53.464, 1e-3);
  EXPECT_NEAR(Design().rod_m(), 0.22165, 1e-5);
}

/// A lander without legs that its engine accelerates by `felt_mps2` against gravity and inertia.
struct Accelerated {
  explicit Accelerated(std::vector<Vector2d> slosh_rad) : lander(design(), {{}, std::move(slosh_rad), 0}) {
    lander.set({felt_mps2 * design().total_kg(), {0, 0, 0}});
  }
  static Design design() {
    Design design = without_damping();
    design.legs.count = 0;
    return design;
  }

  static constexpr double felt_mps2 = 2;
  Lander lander;
};

TEST(Slosh, OppositeSwingsHaveTheFrequencyOfAPendulum) {
  const double start = 1e-4, rate = std::sqrt(Accelerated::felt_mps2 / Accelerated::design().rod_m());
  Accelerated run({{0, start}, {0, -start}});
  for (const double t : {0.5, 2.0, 6.0}) {
    run.lander.advance_to(t);
    EXPECT_NEAR(run.lander.slosh_rad()[0].y(), start * std::cos(rate * t), 1e-4 * start);
    EXPECT_NEAR(run.lander.slosh_rad()[1].y(), -start * std::cos(rate * t), 1e-4 * start);
    EXPECT_LT(rotation_vector(run.lander.bus().attitude).norm(), 1e-4 * start);
  }
}

/// Both tanks about x: a planar body and one pendulum with relative angle d = psi - phi, m and M the masses
/// of propellant and bus, J the bus's inertia, h the hinge above its centre, L the rod, a the felt
/// acceleration:
///   phi'' = -(m a h / J) d,   d'' = -w^2 d,   w^2 = (a / L) (1 + m / M + m h (h - L) / J).
TEST(Slosh, SwingsTogetherTurnTheBus) {
  const Design design = Accelerated::design();
  const double m = 2 * design.slosh_kg(), inertia = design.bus_inertia_kgm2.x(), h = design.tanks.hinge_z_m;
  const double rod = design.rod_m(), a = Accelerated::felt_mps2, start = 1e-4;
  const double rate = std::sqrt(a / rod * (1 + m / design.bus_kg + m * h * (h - rod) / inertia));
  const double coupling = m * a * h / inertia / (rate * rate);
  EXPECT_GT(coupling, 0.05);
  Accelerated run({{start, 0}, {start, 0}});
  for (const double t : {0.5, 2.0, 6.0}) {
    run.lander.advance_to(t);
    EXPECT_NEAR(run.lander.slosh_rad()[0].x(), start * std::cos(rate * t), 1e-4 * start);
    EXPECT_NEAR(rotation_vector(run.lander.bus().attitude).x(), coupling * start * (std::cos(rate * t) - 1),
                1e-4 * start);
  }
}

TEST(Slosh, FrozenPropellantDoesNotMove) {
  Design design;
  design.tanks.swing = false;
  Lander lander(design, {{{}, {}, Quaterniond::Identity(), {0.3, 0.2, 0.1}}, {{0, 0}, {0, 0}}, 0});
  lander.advance_to(3);
  EXPECT_LT(lander.slosh_rad()[0].norm() + lander.slosh_rad()[1].norm(), 1e-12);
}

TEST(Legs, OnAHeavyBusHaveTheirOwnFrequency) {
  Design design = without_damping();
  design.bus_kg = 1e9;
  design.bus_inertia_kgm2.setConstant(1e9);
  Lander lander(design, {{}, {{0, 0}, {0, 0}}, 1e-3});
  for (const double t : {0.1, 0.4, 1.7}) {
    lander.advance_to(t);
    for (const double angle : lander.legs_rad())
      EXPECT_NEAR(angle, 1e-3 * std::cos(2 * kPi * design.legs.frequency_hz * t), 1e-8);
  }
}

TEST(Controls, LagAndLimits) {
  const Actuators::Limits limits;
  Actuators actuators(limits, {1000, {0, 0, 0}});
  Controls now;
  const int steps = 10;  // until one engine lag has passed
  for (int i = 0; i < steps; ++i) now = actuators.follow({9000, {-900, 0, 20}}, limits.thrust_lag_s / steps);
  EXPECT_NEAR(now.thrust_n, limits.thrust_n + (1000 - limits.thrust_n) * std::exp(-1), 1e-9);
  const double share = 1 - std::exp(-limits.thrust_lag_s / limits.torque_lag_s);
  EXPECT_LT((now.torque_nm - share * Vector3d(-limits.torque_nm, 0, 20)).norm(), 1e-9);
}

TEST(Controls, CommandsAgainstTiltAndTowardsTheSite) {
  const Design design;
  const Controller controller({}, design);
  BusState state{{0, 0, 500}, {0, 0, -23}, Quaterniond::Identity(), {0, 0, 0}};
  const Controls at_rest = controller.command(state);
  EXPECT_NEAR(at_rest.thrust_n, design.total_kg() * design.gravity_mps2, 1e-9);
  EXPECT_LT(at_rest.torque_nm.norm(), 1e-12);
  state.attitude = rotation({0.05, 0, 0});
  EXPECT_NEAR(controller.command(state).torque_nm.x(), -160 * 1.44 * 0.05, 1e-9);
  // East of the site it tilts to the west, which is a rotation about -y.
  state = {{1, 0, 500}, {0, 0, -23}, Quaterniond::Identity(), {0, 0, 0}};
  EXPECT_NEAR(controller.command(state).torque_nm.y(), -200 * 1.44 * std::atan(0.04 / 1.315), 1e-9);
}

/// The ray of a lidar mounted at the centre of leg 0 starts where Simbody has that centre, and points down
/// the body's axis, which the centres of the legs give.
/// On the braking curve the engine gives weight and braking; above it, in steady descent, the weight alone.
TEST(Controls, BrakesToStandOnTheSite) {
  const Design design;
  Controller controller({}, design);
  controller.land_at({2, -3, 5});
  const auto thrust = [&](double height_m, double down_mps) {
    const BusState state{
        {2, -3, 5 + design.standing_m() + height_m}, {0, 0, -down_mps}, {1, 0, 0, 0}, {0, 0, 0}};
    return controller.command(state).thrust_n / design.total_kg() - design.gravity_mps2;
  };
  EXPECT_NEAR(thrust(100, std::sqrt(1 + 2 * 0.8 * 100)), 0.8, 1e-9);
  EXPECT_NEAR(thrust(400, 23), 0, 1e-9);
  EXPECT_NEAR(thrust(-0.1, 1), 0, 1e-9);
  EXPECT_NEAR(design.standing_m(), 0.3 + 1.2 * std::sin(0.7), 1e-12);
}

TEST(Host, ThePoseIsThatOfSimbody) {
  Design design;
  Start start = kTumble;
  start.leg_rad = 0;
  Lander lander(design, start);
  const double droop = design.legs.droop_rad, half = design.legs.length_m / 2;
  const double out = (design.legs.hinge_radius_m + half * std::cos(droop)) * std::sqrt(0.5);
  const double down = design.legs.hinge_z_m - half * std::sin(droop);
  landfall::lidar::Ray ray;
  const landfall::lidar::Instrument instrument(
      R"({"detector": {"rows": 1, "columns": 1}, "scanner": {"type": "flash"}, "mount": {"position_m": [)" +
          std::to_string(out) + "," + std::to_string(out) + "," + std::to_string(down) + "]}}",
      [&ray](const landfall::lidar::Ray& traced) {
        ray = traced;
        return 1.0;
      });
  BusState state = lander.bus();
  const landfall::lidar::PulseReturns returns =
      instrument.step(pulse_of(0, {state, state, state}, Knowledge::filter));
  const std::vector<BodyMotion> bodies = lander.bodies();
  const Vector3d axis =
      (bodies[2].centre_m - bodies[1].centre_m).cross(bodies[3].centre_m - bodies[2].centre_m).normalized();
  EXPECT_LT((Vector3d(ray.origin_m.data()) - bodies[1].centre_m).norm(), 2e-6);  // to_string has 6 digits
  EXPECT_LT((Vector3d(ray.direction.data()) + axis).norm(), 1e-12);
  EXPECT_EQ(returns.pixels.at(0).true_m, returns.pixels.at(0).estimated_m);
}

/// Poses at pulse times against a second run of the model that goes to one of these times directly.
TEST(Host, PosesWithinAPeriodAreIntegrated) {
  const FlightPlan plan;
  Flight flight(plan, kNoGround);
  Lander replay(plan.design, plan.start);
  for (int i = 0; i < 200; ++i) {
    replay.set(flight.controls());
    flight.advance();
    replay.advance_to(flight.t_s());
  }
  const double t = flight.t_s();
  replay.set(flight.controls());
  replay.advance_to(t + 0.0042);
  const std::vector<double> times = {t, t + 0.001, t + 0.0042, t + 0.0099};
  const std::vector<PoseSample> samples = flight.advance(times);
  ASSERT_EQ(samples.size(), 4);
  EXPECT_LT((samples[2].truth.position_m - replay.bus().position_m).norm(), 1e-9);
  EXPECT_LT(samples[2].truth.attitude.angularDistance(replay.bus().attitude), 1e-9);
}

/// Exact inertial measurements and no updates: only the integration is left, also between the periods.
TEST(Navigation, ExactSensorsFollowTheTruth) {
  FlightPlan plan;
  plan.errors = {0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0};
  plan.periods_per_update = std::numeric_limits<int>::max();
  Flight flight(plan, kNoGround);
  while (flight.t_s() < 10) {
    const std::array<double, 2> times = {flight.t_s() + 0.003, flight.t_s() + 0.007};
    for (const PoseSample& sample : flight.advance(times)) {
      ASSERT_LT((sample.estimate.position_m - sample.truth.position_m).norm(), 1e-4);
      ASSERT_LT(sample.estimate.attitude.angularDistance(sample.truth.attitude), 1e-5);
      ASSERT_LT((sample.predicted.position_m - sample.truth.position_m).norm(), 2e-4);
      ASSERT_LT(sample.predicted.attitude.angularDistance(sample.truth.attitude), 5e-5);
    }
  }
}

/// Ground whose height is the process that the filter assumes.
class RandomGround {
 public:
  RandomGround(const SensorErrors& errors, double period_s, std::uint64_t seed)
      : sigma_m_(errors.relief_m), kept_(std::exp(-period_s / errors.relief_time_s)), generator_(seed) {
    height_m_ = sigma_m_ * normal_(generator_);
  }
  double operator()(const Vector3d& origin_m, const Vector3d& direction) {
    height_m_ = kept_ * height_m_ + std::sqrt(1 - kept_ * kept_) * sigma_m_ * normal_(generator_);
    return (origin_m.z() - height_m_) / -direction.z();
  }

 private:
  double sigma_m_, kept_;
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
  double height_m_ = 0;
};

/// The normalised squares of the errors of position, velocity and attitude after 8 s, summed over `flights`:
/// if the covariance is true, they have the chi-square distribution with 9 degrees of freedom per flight.
double normalised_squares(FlightPlan plan, int flights) {
  double sum = 0;
  for (int seed = 1; seed <= flights; ++seed) {
    plan.seed = static_cast<std::uint64_t>(seed);
    Flight flight(plan, RandomGround(plan.errors, plan.period_s * plan.periods_per_update, plan.seed + 1000));
    while (flight.t_s() < 8) flight.advance();
    const BusState truth = flight.body().bus(), &estimate = flight.filter().estimate();
    Eigen::Matrix<double, 9, 1> error;
    error << truth.position_m - estimate.position_m, truth.velocity_mps - estimate.velocity_mps,
        rotation_vector(estimate.attitude.conjugate() * truth.attitude);
    const Eigen::Matrix<double, 9, 9> covariance = flight.filter().covariance().topLeftCorner<9, 9>();
    sum += error.dot(covariance.ldlt().solve(error));
  }
  return sum;
}

// 90 degrees of freedom: 0.1 % of filters with a true covariance lie outside.
constexpr double kMin = 52.2, kMax = 140.9;

TEST(Navigation, ErrorsAgreeWithTheCovariance) {
  const double sum = normalised_squares({}, 10);
  EXPECT_GT(sum, kMin);
  EXPECT_LT(sum, kMax);
}

/// The attitude is so badly known, and velocity and height are so well measured, that the filter learns it
/// from them while the lander turns: a wrong sign in its partial derivatives shows.
TEST(Navigation, ErrorsAgreeWithTheCovarianceWhereAttitudeIsLearned) {
  FlightPlan plan;
  plan.errors = {.gyro_bias_radps = 1e-3,
                 .gyro_walk_rad_per_sqrt_s = 1e-4,
                 .accelerometer_bias_mps2 = 3e-2,
                 .accelerometer_walk_mps_per_sqrt_s = 5e-4,
                 .velocimeter_mps = 0.003,
                 .altimeter_m = 0.02,
                 .relief_m = 0.02,
                 .relief_time_s = 5,
                 .start_position_m = 0.2,
                 .start_velocity_mps = 0.1,
                 .start_attitude_rad = 0.004};
  plan.start.bus.attitude = rotation({0.15, -0.2, 0.8});
  plan.start.bus.rate_radps = {0.05, 0.1, 0.3};
  const double sum = normalised_squares(plan, 10);
  EXPECT_GT(sum, kMin);
  EXPECT_LT(sum, kMax);
}

double first_hit_m(const std::vector<double>& z, int columns, const Vector3d& origin,
                   const Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  const auto node = [&](int i, int j) {
    return Vector3d(i, j, z[static_cast<std::size_t>(j * columns + i)]);
  };
  for (int j = 0; j + 1 < static_cast<int>(z.size()) / columns; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      for (const auto& [a, b, c] : {std::array{node(i, j), node(i + 1, j), node(i, j + 1)},
                                    std::array{node(i + 1, j + 1), node(i, j + 1), node(i + 1, j)}}) {
        const Vector3d normal = (b - a).cross(c - a);
        const double t = normal.dot(a - origin) / normal.dot(direction);
        const Vector3d p = origin + t * direction - a;
        const Eigen::Matrix2d edges{{(b - a).x(), (c - a).x()}, {(b - a).y(), (c - a).y()}};
        const Vector2d share = edges.inverse() * p.head<2>();
        if (share.minCoeff() >= -1e-12 && share.sum() <= 1 + 1e-12 && t < nearest) nearest = t;
      }
    }
  }
  return nearest;
}

TEST(Scene, RangesAreThoseOfTheTriangles) {
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  const int columns = 12;
  std::vector<double> z(columns * 10);
  for (double& height : z) height = 2 * uniform(generator);
  const Heightfield ground({0, 0}, 1, columns, z);
  int beyond_first_cell = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d target(2 + 7 * uniform(generator), 2 + 5 * uniform(generator), 2);
    Vector3d direction(uniform(generator) - 0.5, uniform(generator) - 0.5, -0.5);
    if (i % 3 == 0) direction.head<2>().setZero();
    // Through nodes and along edges, too.
    const Vector3d at = i % 5 == 0 ? Vector3d(std::round(target.x()), std::round(target.y()), 2) : target;
    direction.normalize();
    const Vector3d origin = at - 50 * direction;
    const double range =
        ground.range_m({origin.x(), origin.y(), origin.z()}, {direction.x(), direction.y(), direction.z()});
    ASSERT_NEAR(range, first_hit_m(z, columns, origin, direction), 1e-9) << i;
    const Vector3d hit = origin + range * direction;
    beyond_first_cell += std::floor(hit.x()) != std::floor(at.x()) ? 1 : 0;
  }
  EXPECT_GT(beyond_first_cell, 300);
}

TEST(Scene, MissesAreNotANumber) {
  const Heightfield ground({0, 0}, 1, 3, std::vector<double>(9, 0.5));
  EXPECT_TRUE(std::isnan(ground.range_m({1, 1, 5}, {0, 0, 1})));
  EXPECT_TRUE(std::isnan(ground.range_m({5, 1, 5}, {0, 0, -1})));
  EXPECT_EQ(ground.range_m({1, 1, 5}, {0, 0, -1}), 4.5);
}

}  // namespace
}  // namespace lander
