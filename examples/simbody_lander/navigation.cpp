// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D336
#include "navigation.h"

#include <cmath>

namespace lander {

Vector3d rotation_vector(const Quaterniond& rotation) {
  const Eigen::AngleAxisd turn(rotation.w() < 0 ? Quaterniond(-rotation.coeffs()) : rotation);
  return turn.angle() * turn.axis();
}

Quaterniond rotation(const Vector3d& vector) {
  const double angle = vector.norm();
  return angle > 0 ? Quaterniond(Eigen::AngleAxisd(angle, vector / angle)) : Quaterniond::Identity();
}

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Sensors::Sensors(const SensorErrors& errors, double gravity_mps2, std::uint64_t seed)
    : errors_(errors), gravity_mps2_(0, 0, -gravity_mps2), generator_(seed) {
  gyro_bias_ = draw(errors.gyro_bias_radps);
  accelerometer_bias_ = draw(errors.accelerometer_bias_mps2);
}

Vector3d Sensors::draw(double sigma) {
  Vector3d v;
  for (double& element : v) element = sigma * normal_(generator_);
  return v;
}

BusState Sensors::first_estimate(const BusState& truth) {
  BusState estimate = truth;
  estimate.position_m -= draw(errors_.start_position_m);
  estimate.velocity_mps -= draw(errors_.start_velocity_mps);
  estimate.attitude = truth.attitude * rotation(-draw(errors_.start_attitude_rad));
  return estimate;
}

Increment Sensors::increment(const BusState& before, const BusState& after, double period_s) {
  const Vector3d angle = rotation_vector(before.attitude.conjugate() * after.attitude);
  const Vector3d velocity =
      before.attitude.conjugate() * (after.velocity_mps - before.velocity_mps - gravity_mps2_ * period_s);
  const double root = std::sqrt(period_s);
  return {period_s, angle + gyro_bias_ * period_s + draw(errors_.gyro_walk_rad_per_sqrt_s * root),
          velocity + accelerometer_bias_ * period_s + draw(errors_.accelerometer_walk_mps_per_sqrt_s * root)};
}

Vector3d Sensors::velocity_in_body(const BusState& truth) {
  return truth.attitude.conjugate() * truth.velocity_mps + draw(errors_.velocimeter_mps);
}

double Sensors::altimeter(double range_m) { return range_m + errors_.altimeter_m * normal_(generator_); }

NavigationFilter::NavigationFilter(const SensorErrors& errors, double gravity_mps2, const BusState& first)
    : errors_(errors), gravity_mps2_(0, 0, -gravity_mps2), estimate_(first) {
  const double sigmas[] = {errors.start_position_m, errors.start_velocity_mps,      errors.start_attitude_rad,
                           errors.gyro_bias_radps,  errors.accelerometer_bias_mps2, errors.relief_m};
  for (int i = 0; i < kStates; ++i) covariance_(i, i) = sigmas[i / 3] * sigmas[i / 3];
}

Increment NavigationFilter::corrected(Increment measured) const {
  measured.angle_rad -= gyro_bias_ * measured.period_s;
  measured.velocity_mps -= accelerometer_bias_ * measured.period_s;
  return measured;
}

BusState NavigationFilter::after(double fraction, const Increment& measured) const {
  const Increment increment = corrected(measured);
  const double dt = fraction * increment.period_s;
  const Vector3d change =
      fraction * (estimate_.attitude * increment.velocity_mps + gravity_mps2_ * increment.period_s);
  BusState later;
  later.position_m = estimate_.position_m + (estimate_.velocity_mps + change / 2) * dt;
  later.velocity_mps = estimate_.velocity_mps + change;
  later.attitude = (estimate_.attitude * rotation(fraction * increment.angle_rad)).normalized();
  later.rate_radps = increment.angle_rad / increment.period_s;
  return later;
}

void NavigationFilter::propagate(const Increment& measured) {
  const Increment increment = corrected(measured);
  const double dt = increment.period_s;
  const Matrix3d R_dem_body = estimate_.attitude.toRotationMatrix();
  Covariance step = Covariance::Identity();
  step.block<3, 3>(kPosition, kVelocity) = dt * Matrix3d::Identity();
  step.block<3, 3>(kVelocity, kAttitude) = -R_dem_body * cross_matrix(increment.velocity_mps);
  step.block<3, 3>(kVelocity, kAccelerometerBias) = -dt * R_dem_body;
  step.block<3, 3>(kAttitude, kAttitude) = rotation(-increment.angle_rad).toRotationMatrix();
  step.block<3, 3>(kAttitude, kGyroBias) = -dt * Matrix3d::Identity();
  const double kept = std::exp(-dt / errors_.relief_time_s);
  step(kGround, kGround) = kept;
  covariance_ = step * covariance_ * step.transpose();
  const double velocity = errors_.accelerometer_walk_mps_per_sqrt_s, angle = errors_.gyro_walk_rad_per_sqrt_s;
  covariance_.diagonal().segment<3>(kVelocity).array() += velocity * velocity * dt;
  covariance_.diagonal().segment<3>(kAttitude).array() += angle * angle * dt;
  covariance_(kGround, kGround) += (1 - kept * kept) * errors_.relief_m * errors_.relief_m;
  ground_m_ *= kept;
  estimate_ = after(1, measured);
}

void NavigationFilter::update(double innovation, const Row& partials, double sigma) {
  const Eigen::Matrix<double, kStates, 1> gain =
      covariance_ * partials.transpose() / (partials * covariance_ * partials.transpose() + sigma * sigma);
  const Covariance rest = Covariance::Identity() - gain * partials;
  covariance_ = rest * covariance_ * rest.transpose() + sigma * sigma * gain * gain.transpose();
  const Eigen::Matrix<double, kStates, 1> error = gain * innovation;
  estimate_.position_m += error.segment<3>(kPosition);
  estimate_.velocity_mps += error.segment<3>(kVelocity);
  estimate_.attitude = (estimate_.attitude * rotation(error.segment<3>(kAttitude))).normalized();
  gyro_bias_ += error.segment<3>(kGyroBias);
  accelerometer_bias_ += error.segment<3>(kAccelerometerBias);
  ground_m_ += error[kGround];
}

void NavigationFilter::update_velocity(const Vector3d& measured_in_body_mps) {
  for (int axis = 0; axis < 3; ++axis) {
    const Matrix3d R_body_dem = estimate_.attitude.conjugate().toRotationMatrix();
    const Vector3d expected = R_body_dem * estimate_.velocity_mps;
    Row partials = Row::Zero();
    partials.segment<3>(kVelocity) = R_body_dem.row(axis);
    partials.segment<3>(kAttitude) = cross_matrix(expected).row(axis);
    update(measured_in_body_mps[axis] - expected[axis], partials, errors_.velocimeter_mps);
  }
}

void NavigationFilter::update_altitude(double measured_m) {
  const Matrix3d R_dem_body = estimate_.attitude.toRotationMatrix();
  const double altitude = estimate_.position_m.z() - ground_m_, cosine = R_dem_body(2, 2);
  Row partials = Row::Zero();
  partials[kPosition + 2] = 1 / cosine;
  partials[kGround] = -1 / cosine;
  // d cosine = R(2, 0) error_y - R(2, 1) error_x
  partials[kAttitude] = altitude / (cosine * cosine) * R_dem_body(2, 1);
  partials[kAttitude + 1] = -altitude / (cosine * cosine) * R_dem_body(2, 0);
  update(measured_m - altitude / cosine, partials, errors_.altimeter_m);
}

}  // namespace lander
