// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D327
#include "scanner/encoder_harmonics.h"

#include <string>

#include "base/parameter_check.h"
#include "base/portable_math.h"

namespace landfall {
namespace {

constexpr int kMaxOrder = 1 << 20;

}  // namespace

void check(const std::vector<EncoderHarmonic>& harmonics) {
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    const EncoderHarmonic& harmonic = harmonics[i];
    const std::string name = "encoder_harmonics/" + std::to_string(i);
    require(harmonic.axis == 1 || harmonic.axis == 2, {name, "axis"}, harmonic.axis, "1 or 2");
    require(harmonic.order >= 1 && harmonic.order <= kMaxOrder, {name, "order"}, harmonic.order,
            "in 1..1048576");
    require_finite({name, "amplitude_rad"}, harmonic.amplitude_rad);
    require_finite({name, "phase_deg"}, harmonic.phase_rad);
  }
}

TiltAngles encoder_error(const std::vector<EncoderHarmonic>& harmonics, const TiltAngles& angles) {
  TiltAngles error;
  for (const EncoderHarmonic& harmonic : harmonics) {
    const double angle = harmonic.axis == 1 ? angles.angle_1_rad : angles.angle_2_rad;
    double& sum = harmonic.axis == 1 ? error.angle_1_rad : error.angle_2_rad;
    sum += harmonic.amplitude_rad * portable::sin(harmonic.order * angle + harmonic.phase_rad);
  }
  return error;
}

}  // namespace landfall
