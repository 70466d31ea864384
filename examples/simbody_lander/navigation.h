// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>

#include "lander.h"

namespace lander {

Vector3d rotation_vector(const Quaterniond& rotation);
Quaterniond rotation(const Vector3d& vector);
Matrix3d cross_matrix(const Vector3d& v);

/// One sigma of what the sensors get wrong, and of the knowledge before the first measurement. The filter
/// knows these numbers, not the errors.
struct SensorErrors {
  double gyro_bias_radps = 5e-6;           ///< 1 deg/h
  double gyro_walk_rad_per_sqrt_s = 2e-5;  ///< 0.07 deg/sqrt(h)
  double accelerometer_bias_mps2 = 3e-3;   ///< 300 micro-g
  double accelerometer_walk_mps_per_sqrt_s = 5e-4;
  double velocimeter_mps = 0.03;  ///< per axis of B
  double altimeter_m = 0.05;
  double relief_m = 0.5;          ///< of the ground under the altimeter, from z = 0
  double relief_time_s = 5;       ///< in which the altimeter comes to other ground
  double start_position_m = 0.2;  ///< per axis of D: a fix by terrain-relative navigation
  double start_velocity_mps = 0.1;
  double start_attitude_rad = 1e-4;  ///< per axis of B: a star tracker
};

/// The increments that an inertial measurement unit integrates over one period, in B at the start of the
/// period.
struct Increment {
  double period_s = 0;
  Vector3d angle_rad{0, 0, 0};
  Vector3d velocity_mps{0, 0, 0};  ///< without gravity
};

/// Measures the true motion with errors that depend only on the seed.
class Sensors {
 public:
  Sensors(const SensorErrors& errors, double gravity_mps2, std::uint64_t seed);
  [[nodiscard]] BusState first_estimate(const BusState& truth);
  [[nodiscard]] Increment increment(const BusState& before, const BusState& after, double period_s);
  [[nodiscard]] Vector3d velocity_in_body(const BusState& truth);
  [[nodiscard]] double altimeter(double range_m);

 private:
  [[nodiscard]] Vector3d draw(double sigma);

  SensorErrors errors_;
  Vector3d gravity_mps2_;
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
  Vector3d gyro_bias_, accelerometer_bias_;
};

/// Strapdown integration with an extended Kalman filter for its errors: position, velocity, attitude, the
/// biases of the inertial sensors, and the height of the ground under the altimeter, a Gauss-Markov process.
/// The attitude's error is a rotation in B: true = estimate * rotation(error).
class NavigationFilter {
 public:
  static constexpr int kStates = 16;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;
  enum Block {
    kPosition = 0,
    kVelocity = 3,
    kAttitude = 6,
    kGyroBias = 9,
    kAccelerometerBias = 12,
    kGround = 15
  };

  NavigationFilter(const SensorErrors& errors, double gravity_mps2, const BusState& first);

  void propagate(const Increment& measured);
  void update_velocity(const Vector3d& measured_in_body_mps);
  /// The range along -z_B to the ground.
  void update_altitude(double measured_m);

  /// The estimate `fraction` of a period later, if the sensors measure `measured` in that period.
  [[nodiscard]] BusState after(double fraction, const Increment& measured) const;
  [[nodiscard]] const BusState& estimate() const { return estimate_; }
  [[nodiscard]] const Covariance& covariance() const { return covariance_; }

 private:
  using Row = Eigen::Matrix<double, 1, kStates>;
  void update(double innovation, const Row& partials, double sigma);
  [[nodiscard]] Increment corrected(Increment measured) const;

  SensorErrors errors_;
  Vector3d gravity_mps2_;
  BusState estimate_;
  Vector3d gyro_bias_{0, 0, 0}, accelerometer_bias_{0, 0, 0};
  double ground_m_ = 0;
  Covariance covariance_ = Covariance::Zero();
};

}  // namespace lander
