// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>

#include "chain/lidar/scanner/pattern.h"
#include "test_seed.h"

namespace landfall {

/// Random numbers of a property test.
class PatternRandom {
 public:
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }

 private:
  std::mt19937_64 engine_{test_seed()};
};

/// The aim of a pulse, which must have one.
inline Eigen::Vector3d aim_of(const Pattern& pattern, const PulseTime& pulse) {
  return pattern.aim_point(pulse).value().v;
}

/// The aim by time alone, for patterns that do not count pulses.
inline Eigen::Vector3d aim_at(const Pattern& pattern, double t_s) { return aim_of(pattern, {0, t_s}); }

}  // namespace landfall
