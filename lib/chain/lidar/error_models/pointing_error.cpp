// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D87, D324
#include "chain/lidar/error_models/pointing_error.h"

#include <cmath>

#include "base/geometry/vector_check.h"

namespace landfall {
namespace {

double biased(double bias, double sigma, const RandomField& field, std::int64_t pulse) {
  return sigma == 0 ? bias : bias + sigma * field.normal(static_cast<std::uint64_t>(pulse));
}

}  // namespace

PointingError::PointingError(const PointingErrorParameters& parameters, RandomSeed seed)
    : parameters_(parameters),
      turns_beams_(parameters.misalignment != RollPitchYaw{} || parameters.jitter_sigma_x_rad != 0 ||
                   parameters.jitter_sigma_y_rad != 0),
      misalignment_(rotation_from<LidarFrame, LidarFrame>(parameters.misalignment)),
      jitter_(seed, RandomStream::pointing_jitter),
      time_stamp_(seed, RandomStream::time_stamp),
      mirror_time_(seed, RandomStream::mirror_time) {
  require_finite({"", "misalignment_rpy_rad"}, parameters.misalignment);
  require_not_negative({"", "jitter_sigma_rad"}, parameters.jitter_sigma_x_rad);
  require_not_negative({"", "jitter_sigma_rad"}, parameters.jitter_sigma_y_rad);
  require(std::abs(parameters.time_stamp_bias_s) <= 1e6, {"", "time_stamp_bias_s"},
          parameters.time_stamp_bias_s, "in [-1e6, 1e6]");
  require(parameters.time_stamp_sigma_s >= 0 && parameters.time_stamp_sigma_s <= 1e6,
          {"", "time_stamp_sigma_s"}, parameters.time_stamp_sigma_s, "in [0, 1e6]");
  require(std::abs(parameters.mirror_time_bias_s) <= 1, {"", "mirror_time_bias_s"},
          parameters.mirror_time_bias_s, "in [-1, 1]");
  require(parameters.mirror_time_sigma_s >= 0 && parameters.mirror_time_sigma_s <= 1,
          {"", "mirror_time_sigma_s"}, parameters.mirror_time_sigma_s, "in [0, 1]");
  require(parameters.jitter_time_s >= 0 && parameters.jitter_time_s <= 1e6, {"", "jitter_time_s"},
          parameters.jitter_time_s, "in [0, 1e6]");
  if (parameters.jitter_time_s == 0) return;
  require_positive({"", "pulse_interval_s"}, parameters.pulse_interval_s);
  jitter_process_.emplace(parameters.pulse_interval_s / parameters.jitter_time_s);
}

Rotation<LidarFrame, LidarFrame> PointingError::rotation(std::int64_t pulse) const {
  const auto i = static_cast<std::uint64_t>(pulse);
  const auto draw = [&](double sigma, std::uint64_t axis) {
    if (sigma == 0) return 0.0;
    return sigma * (jitter_process_ ? jitter_process_->at(pulse, jitter_, axis) : jitter_.normal(i, axis));
  };
  const RollPitchYaw jitter{draw(parameters_.jitter_sigma_x_rad, 0), draw(parameters_.jitter_sigma_y_rad, 1)};
  if (jitter == RollPitchYaw{}) return misalignment_;
  return misalignment_ * rotation_from<LidarFrame, LidarFrame>(jitter);
}

double PointingError::time_stamp_error_s(std::int64_t pulse) const {
  return biased(parameters_.time_stamp_bias_s, parameters_.time_stamp_sigma_s, time_stamp_, pulse);
}

double PointingError::mirror_time_error_s(std::int64_t pulse) const {
  return biased(parameters_.mirror_time_bias_s, parameters_.mirror_time_sigma_s, mirror_time_, pulse);
}

double PointingError::largest_time_stamp_error_s() const {
  return parameters_.time_stamp_bias_s + 9 * parameters_.time_stamp_sigma_s;
}

}  // namespace landfall
