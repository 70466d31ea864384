// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/geometry/frames.h"
#include "base/geometry/rotation.h"
#include "base/numerics/random_seed.h"

namespace landfall {

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180;

inline double number(const nlohmann::json& owner, const char* key) { return owner.at(key).get<double>(); }

/// The value of a key in degrees, converted to radians.
inline double radians(const nlohmann::json& owner, const char* key_deg) {
  return kRadiansPerDegree * number(owner, key_deg);
}

/// An array of two numbers, or one number that is used for both.
inline std::array<double, 2> pair_of(const nlohmann::json& value) {
  if (value.is_array()) return value.get<std::array<double, 2>>();
  return {value.get<double>(), value.get<double>()};
}

/// An array of three numbers.
inline Eigen::Vector3d vector3(const nlohmann::json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

/// The random numbers of a resolved configuration of a terrain or of a scan.
inline RandomSeed random_seed(const nlohmann::json& config) {
  return {config.at("seed").get<std::uint64_t>(), config.at("draw").get<std::uint32_t>()};
}

inline RollPitchYaw roll_pitch_yaw(const nlohmann::json& value, double radians_per_unit) {
  const Eigen::Vector3d angles = radians_per_unit * vector3(value);
  return {angles.x(), angles.y(), angles.z()};
}

}  // namespace landfall
