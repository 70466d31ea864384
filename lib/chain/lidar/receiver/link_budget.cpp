// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D340
#include "chain/lidar/receiver/link_budget.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "base/core/error.h"
#include "base/numerics/light.h"
#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"

namespace landfall {

using std::numbers::pi;

Illumination::Illumination(const IlluminationParameters& parameters)
    : parameters_(parameters),
      axis_(Direction<LidarFrame>::of(
          {{portable::tan(parameters.offset_x_rad), portable::tan(parameters.offset_y_rad), 1}})) {
  if (const auto divergence = parameters.divergence_rad)
    require(*divergence > 0 && *divergence < pi, {"", "divergence_rad"}, *divergence, "in (0, pi)");
  require(std::abs(parameters.offset_x_rad) < pi / 2, {"", "offset_rad/0"}, parameters.offset_x_rad,
          "in (-pi/2, pi/2)");
  require(std::abs(parameters.offset_y_rad) < pi / 2, {"", "offset_rad/1"}, parameters.offset_y_rad,
          "in (-pi/2, pi/2)");
}

double Illumination::relative(const Direction<LidarFrame>& direction) const {
  if (!parameters_.divergence_rad) return 1;
  const double theta_rad = portable::atan2(axis_.v.cross(direction.v).norm(), axis_.v.dot(direction.v));
  const double of_radius = 2 * theta_rad / *parameters_.divergence_rad;
  if (parameters_.profile == BeamProfile::top_hat) return of_radius <= 1 ? 1 : 0;
  return portable::exp(-2 * of_radius * of_radius);
}

std::optional<double> Illumination::peak_per_sr() const {
  if (!parameters_.divergence_rad) return std::nullopt;
  const double radius_rad = *parameters_.divergence_rad / 2;
  const double top_hat = 1 / (pi * radius_rad * radius_rad);
  return parameters_.profile == BeamProfile::top_hat ? top_hat : 2 * top_hat;
}

double link_constant_pe_m2(const ReferenceSignal& reference) {
  require_positive({"", "reference_pe"}, reference.pe);
  require_positive({"", "reference_range_m"}, reference.range_m);
  return reference.pe * reference.range_m * reference.range_m;
}

double link_constant_pe_m2(const LinkDesign& design, double pixel_sr, const Illumination& beam) {
  constexpr double kPlanck_Js = 6.62607015e-34;
  require_positive({"", "pulse_energy_J"}, design.pulse_energy_J);
  require_positive({"", "wavelength_m"}, design.wavelength_m);
  require_positive({"", "aperture_m"}, design.aperture_m);
  require(design.efficiency > 0 && design.efficiency <= 1, {"", "efficiency"}, design.efficiency,
          "in (0, 1]");
  const auto peak_per_sr = beam.peak_per_sr();
  if (!peak_per_sr) throw UsageError("pulse_energy_J: needs /beam/divergence_rad");
  const double photons = design.pulse_energy_J * design.wavelength_m / (kPlanck_Js * kSpeedOfLight_mps);
  return photons * design.efficiency * pixel_sr * *peak_per_sr * design.aperture_m * design.aperture_m / 4;
}

}  // namespace landfall
