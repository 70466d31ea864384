// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>

#include "chain/lidar/scanner/scanner.h"
#include "constants.h"
#include "test_seed.h"

// Helpers of the scanner tests.
namespace landfall {

/// A unit vector `off_rad` away from +z, towards (cos azimuth, sin azimuth).
inline Direction<LidarFrame> towards(double off_rad, double azimuth_rad) {
  return {{std::sin(off_rad) * std::cos(azimuth_rad), std::sin(off_rad) * std::sin(azimuth_rad),
           std::cos(off_rad)}};
}

inline Beam beam_of(const Scanner& scanner, const ScannerState& state, const Eigen::Vector3d& pixel) {
  const std::array<Direction<LidarFrame>, 1> pixels{{{pixel}}};
  std::array<Beam, 1> beams;
  scanner.steer(state, pixels, beams);
  return beams[0];
}

/// The boresight after the scanner.
inline Eigen::Vector3d line_of_sight(const Scanner& scanner, const ScannerState& state) {
  return beam_of(scanner, state, Eigen::Vector3d::UnitZ()).direction.v;
}

/// Rotation of the image about the line of sight, right-handed about it, relative to the shortest turn that
/// takes +z to the line of sight.
double image_rotation(const Scanner& scanner, const ScannerState& state);

inline Eigen::Matrix3d turn_about(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

/// The reflection d - 2 (d.m) m.
inline Eigen::Vector3d reflected(const Eigen::Vector3d& d, const Eigen::Vector3d& m) {
  return d - 2 * d.dot(m) * m;
}

/// Random cases of a property test: LANDFALL_TEST_SEED, or a fixed seed, which is logged.
class RandomCases {
 public:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Direction<LidarFrame> within(double max_off_rad) { return towards(uniform(0, max_off_rad), uniform(0, 7)); }

 private:
  std::mt19937_64 engine_{test_seed()};
};

}  // namespace landfall
