// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D70
#include "chain/lidar/scanner/risley_steering.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/geometry/vector_check.h"
#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

using std::numbers::pi;
/// The tolerance of the reach, whose ends are rounded themselves: an aim this far outside counts as inside.
constexpr double kEdge = 1e-15;

/// m: the transverse component of the beam after prism 1, along u(theta_1). NaN for total reflection.
double across_behind(const RisleyPrism& prism, bool exit_is_tilted) {
  const double n = prism.index;
  const double s = portable::sin(prism.wedge_rad);
  const double c = portable::cos(prism.wedge_rad);
  if (exit_is_tilted) return -s * (n * c - std::sqrt(1 - n * n * s * s));
  return s * (std::sqrt(n * n - s * s) - c);
}

double root_of_positive(double value) { return std::sqrt(std::max(value, 0.0)); }

}  // namespace

void check(const RisleyOptics& optics) {
  for (std::size_t i = 0; i < optics.prisms.size(); ++i) {
    const RisleyPrism& prism = optics.prisms[i];
    const auto name = [&](const char* key) {
      return ParameterName{"", std::string(key) + "/" + std::to_string(i)};
    };
    require(prism.index > 1 && prism.index <= 10, name("index"), prism.index, "in (1, 10]");
    require_angle(prism.wedge_rad >= 0 && prism.wedge_rad < pi / 2, name("wedge_deg"), prism.wedge_rad,
                  "in [0, 90)");
    require(prism.thickness_m > 0 && prism.thickness_m <= 10, name("thickness_m"), prism.thickness_m,
            "in (0, 10]");
  }
  require(optics.gap_m >= 0 && optics.gap_m <= 10, {"", "gap_m"}, optics.gap_m, "in [0, 10]");
}

bool tilted_at_exit(RisleyConfiguration configuration, std::size_t prism) {
  using enum RisleyConfiguration;
  const RisleyConfiguration mirrored = prism == 0 ? pttp : tppt;
  return configuration == ptpt || configuration == mirrored;
}

RisleySteering::RisleySteering(const RisleyOptics& optics)
    : exit_is_tilted_(tilted_at_exit(optics.configuration, 1)),
      index_squared_(optics.prisms[1].index * optics.prisms[1].index),
      sine_(portable::sin(optics.prisms[1].wedge_rad)),
      cosine_(portable::cos(optics.prisms[1].wedge_rad)),
      across_(across_behind(optics.prisms[0], tilted_at_exit(optics.configuration, 0))),
      before_(std::sqrt((exit_is_tilted_ ? index_squared_ : 1) - across_ * across_)) {}

std::optional<Direction<LidarFrame>> RisleySteering::direction(const RisleyAngles& angles) const {
  const double turn = angles.theta_2_rad - angles.theta_1_rad;
  const double meets = across_ * sine_ * portable::cos(turn) + before_ * cosine_;
  const double bend = exit_is_tilted_ ? 1 - index_squared_ : index_squared_ - 1;
  const double radicand = meets * meets + bend;
  // The test is negated so that NaN (total reflection in prism 1) is caught too.
  if (!(meets > 0 && radicand >= 0)) return std::nullopt;
  const double h = std::sqrt(radicand) - meets;
  const double x =
      across_ * portable::cos(angles.theta_1_rad) + h * sine_ * portable::cos(angles.theta_2_rad);
  const double y =
      across_ * portable::sin(angles.theta_1_rad) + h * sine_ * portable::sin(angles.theta_2_rad);
  if (exit_is_tilted_) return Direction<LidarFrame>{{x, y, before_ + h * cosine_}};
  const double rest = 1 - x * x - y * y;
  if (rest < 0) return std::nullopt;
  return Direction<LidarFrame>{{x, y, std::sqrt(rest)}};
}

double RisleySteering::bend_at_tilted_face(double sine, double cosine) const {
  if (exit_is_tilted_) return (cosine - before_) / cosine_;
  return (std::sqrt(index_squared_ - sine * sine) - before_) / cosine_;
}

std::optional<RisleyAngles> RisleySteering::angles(const Direction<LidarFrame>& aim,
                                                   RisleyBranch branch) const {
  const double sine = portable::hypot(aim.v.x(), aim.v.y());
  const double h = bend_at_tilted_face(sine, aim.v.z());
  // The triangle formed by the contributions of the two prisms and their sum.
  const double a = std::abs(across_);
  const double b = std::abs(h) * sine_;
  // Beyond this bound, or with the other sign, h is a root that belongs to no beam through the face.
  const double largest_h = std::sqrt(index_squared_ - 1);
  const bool beam_meets_face =
      aim.v.z() > 0 && (exit_is_tilted_ ? h < 0 && h >= -largest_h : h > 0 && h <= largest_h);
  if (!(beam_meets_face && sine <= a + b + kEdge && sine >= std::abs(a - b) - kEdge)) return std::nullopt;
  // The angle between the contributions from its half angle, by differences of squares: an arc cosine would
  // lose half of the digits at both ends of the reach.
  const double between = 2 * portable::atan2(root_of_positive((a + b - sine) * (a + b + sine)),
                                             root_of_positive((sine - (a - b)) * (sine + (a - b))));
  const double turn_size = across_ * h > 0 ? between : pi - between;
  const double turn = branch == RisleyBranch::positive ? turn_size : -turn_size;
  const double azimuth =
      portable::atan2(h * sine_ * portable::sin(turn), across_ + h * sine_ * portable::cos(turn));
  const double theta_1 = portable::atan2(aim.v.y(), aim.v.x()) - azimuth;
  return RisleyAngles{std::remainder(theta_1, 2 * pi), std::remainder(theta_1 + turn, 2 * pi)};
}

std::optional<double> RisleySteering::deflection(double theta_2_rad) const {
  const auto beam = direction({0, theta_2_rad});
  if (!beam) return std::nullopt;
  return portable::atan2(portable::hypot(beam->v.x(), beam->v.y()), beam->v.z());
}

std::optional<RisleyReach> RisleySteering::reach() const {
  const auto aligned = deflection(0);
  const auto opposed = deflection(pi);
  if (!aligned && !opposed) return std::nullopt;
  if (aligned && opposed) return RisleyReach{std::min(*aligned, *opposed), std::max(*aligned, *opposed)};
  // At one end the boresight is totally reflected: the beam leaves along the face.
  const double grazing =
      exit_is_tilted_ ? portable::acos(before_ - std::sqrt(index_squared_ - 1) * cosine_) : pi / 2;
  return RisleyReach{aligned ? *aligned : *opposed, grazing};
}

}  // namespace landfall
