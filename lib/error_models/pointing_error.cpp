// SPDX-License-Identifier: GPL-3.0-or-later
#include "error_models/pointing_error.h"

#include <cmath>

#include "geometry/parameter_check.h"

namespace landfall {

PointingError::PointingError(const PointingErrorParameters& parameters, std::uint64_t seed)
    : parameters_(parameters),
      turns_beams_(parameters.misalignment != RollPitchYaw{} || parameters.jitter_sigma_x_rad != 0 ||
                   parameters.jitter_sigma_y_rad != 0),
      misalignment_(rotation_from<LidarFrame, LidarFrame>(parameters.misalignment)),
      jitter_(seed, RandomStream::pointing_jitter),
      time_stamp_(seed, RandomStream::time_stamp) {
  require_finite({"", "misalignment_rpy_rad"}, parameters.misalignment);
  require_not_negative({"", "jitter_sigma_rad"}, parameters.jitter_sigma_x_rad);
  require_not_negative({"", "jitter_sigma_rad"}, parameters.jitter_sigma_y_rad);
  require(std::abs(parameters.time_stamp_bias_s) <= 1e6, {"", "time_stamp_bias_s"},
          parameters.time_stamp_bias_s, "in [-1e6, 1e6]");
  require(parameters.time_stamp_sigma_s >= 0 && parameters.time_stamp_sigma_s <= 1e6,
          {"", "time_stamp_sigma_s"}, parameters.time_stamp_sigma_s, "in [0, 1e6]");
}

Rotation<LidarFrame, LidarFrame> PointingError::turn(std::int64_t pulse) const {
  const auto i = static_cast<std::uint64_t>(pulse);
  const auto draw = [&](double sigma, std::uint64_t axis) {
    return sigma == 0 ? 0 : sigma * jitter_.normal(i, axis);
  };
  const RollPitchYaw jitter{draw(parameters_.jitter_sigma_x_rad, 0), draw(parameters_.jitter_sigma_y_rad, 1)};
  if (jitter == RollPitchYaw{}) return misalignment_;
  return misalignment_ * rotation_from<LidarFrame, LidarFrame>(jitter);
}

double PointingError::time_stamp_error_s(std::int64_t pulse) const {
  const double sigma = parameters_.time_stamp_sigma_s;
  if (sigma == 0) return parameters_.time_stamp_bias_s;
  return parameters_.time_stamp_bias_s + sigma * time_stamp_.normal(static_cast<std::uint64_t>(pulse));
}

double PointingError::largest_time_stamp_error_s() const {
  return parameters_.time_stamp_bias_s + 9 * parameters_.time_stamp_sigma_s;
}

}  // namespace landfall
