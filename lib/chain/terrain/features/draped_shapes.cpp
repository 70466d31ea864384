// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D110
#include "chain/terrain/features/draped_shapes.h"

#include "base/numerics/random.h"

namespace landfall {
namespace {

double smooth(double t) { return t * t * (3 - 2 * t); }

/// A lattice index as a counter of draws: negative ones wrap.
std::uint64_t counter(double whole) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(whole)); }

}  // namespace

void PenitenteField::validate(const std::string& owner) const {
  if (diameter_m == 0) {
    const char* const kBound = "finite and positive, which a field without diameter_m requires";
    require(std::isfinite(length_m) && length_m > 0, {owner, "length_m"}, length_m, kBound);
    require(std::isfinite(width_m) && width_m > 0, {owner, "width_m"}, width_m, kBound);
  } else {
    require_positive({owner, "diameter_m"}, diameter_m);
    require(length_m == 0, {owner, "length_m"}, length_m, "allowed with diameter_m, which describes a disc");
    require(width_m == 0, {owner, "width_m"}, width_m, "allowed with diameter_m, which describes a disc");
  }
  require_positive({owner, "amplitude_m"}, amplitude_m);
  require_positive({owner, "wavelength_m"}, wavelength_m);
  require_positive({owner, "exponent"}, exponent);
  const double min_m = diameter_m > 0 ? diameter_m : std::min(length_m, width_m);
  require(edge_m >= 0 && edge_m <= min_m / 2, {owner, "edge_m"}, edge_m, "in [0, half the least extent]");
  require_finite({owner, "yaw_rad"}, yaw_rad);
  require_not_negative({owner, "wobble_m"}, wobble_m);
  if (wobble_m == 0) return;
  require_positive({owner, "wobble_length_m"}, wobble_length_m);
  require(reach_m() <= 1e9 * wobble_length_m, {owner, "wobble_length_m"}, wobble_length_m,
          "at least 1e-9 of the field");
}

double PenitenteField::reach_m() const {
  return diameter_m > 0 ? diameter_m / 2 : portable::hypot(length_m, width_m) / 2;
}

FeatureSize PenitenteField::size() const {
  if (diameter_m > 0) return {diameter_m, amplitude_m, yaw_rad};
  return FeatureSize::of_rectangle(length_m, width_m, amplitude_m, yaw_rad);
}

double PenitenteField::relief_m(const Offset& offset) const {
  return own_relief_m(TurnedAxes(yaw_rad).own(offset));
}

double PenitenteField::own_relief_m(const Offset& own) const {
  const double edge_factor = edge(own);
  if (edge_factor < 0) return kNoRelief;
  const double waves = (own.y_m + (wobble_m > 0 ? wobble_m * noise(own) : 0)) / wavelength_m;
  const double blade = 1 - std::abs(2 * (waves - std::floor(waves)) - 1);
  return amplitude_m * portable::pow(blade, exponent) * edge_factor;
}

double PenitenteField::edge(const Offset& own) const {
  if (diameter_m > 0) {
    const double inside_m = diameter_m / 2 - portable::hypot(own.x_m, own.y_m);
    return inside_m >= 0 ? taper(inside_m, edge_m) : -1;
  }
  const double inside_u_m = length_m / 2 - std::abs(own.x_m);
  const double inside_v_m = width_m / 2 - std::abs(own.y_m);
  return inside_u_m >= 0 && inside_v_m >= 0 ? taper(inside_u_m, edge_m) * taper(inside_v_m, edge_m) : -1;
}

double PenitenteField::noise(const Offset& own) const {
  const RandomField random(seed, RandomStream::penitente);
  const double u = own.x_m / wobble_length_m;
  const double v = own.y_m / wobble_length_m;
  const double i = std::floor(u);
  const double j = std::floor(v);
  const auto corner = [&](double di, double dj) {
    return 2 * random.uniform(counter(i + di), counter(j + dj)) - 1;
  };
  const double along = smooth(u - i);
  const double south = corner(0, 0) + along * (corner(1, 0) - corner(0, 0));
  const double north = corner(0, 1) + along * (corner(1, 1) - corner(0, 1));
  return south + smooth(v - j) * (north - south);
}

}  // namespace landfall
