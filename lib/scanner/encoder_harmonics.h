// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scanner/tilt_angles.h"

namespace landfall {

/// One harmonic of an encoder's nonlinearity: the reading of an angle a is a + amplitude sin(order a +
/// phase). Order 1 is an eccentric disc, 2 an elliptic one; the number of lines of the disc is the error of
/// the interpolation between two of them.
struct EncoderHarmonic {
  int axis = 1;              ///< 1: angle_1, 2: angle_2
  int order = 1;             ///< 1 .. 2^20
  double amplitude_rad = 0;  ///< finite
  double phase_rad = 0;      ///< finite
};

/// Throws UsageError, naming encoder_harmonics/i/key and the bound, for a parameter out of range.
void check(const std::vector<EncoderHarmonic>& harmonics);

/// The readings minus the angles.
[[nodiscard]] TiltAngles encoder_error(const std::vector<EncoderHarmonic>& harmonics,
                                       const TiltAngles& angles);

}  // namespace landfall
