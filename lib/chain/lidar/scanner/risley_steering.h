// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <numbers>
#include <optional>

#include "base/geometry/frames.h"

namespace landfall {

/// Which face of each prism is tilted, in the order of the beam; P plane, T tilted.
enum class RisleyConfiguration { pttp, tppt, ptpt, tptp };

struct RisleyPrism {
  double index = 1.5;                               ///< of refraction, in (1, 10]
  double wedge_rad = 8.5 * std::numbers::pi / 180;  ///< between its two faces, in [0, pi/2)
  double thickness_m = 0.006;                       ///< on the axis, in (0, 10]
};

/// Two wedge prisms that turn about the optical axis, +z_L. The gap is measured on the axis, in [0, 10].
struct RisleyOptics {
  std::array<RisleyPrism, 2> prisms{};
  double gap_m = 0.004;
  RisleyConfiguration configuration = RisleyConfiguration::pttp;
};

/// Throws UsageError, naming the key and the bound, for a value out of range.
void check(const RisleyOptics& optics);

/// True if the tilted face of prism `prism` (0 or 1) is the one where the beam leaves it.
[[nodiscard]] bool tilted_at_exit(RisleyConfiguration configuration, std::size_t prism);

/// The rotation angles of the prisms, right-handed about +z_L; at 0 the normal of the tilted face, taken
/// along the beam, leans towards +x_L.
struct RisleyAngles {
  double theta_1_rad = 0;
  double theta_2_rad = 0;
};

/// Two pairs of angles give the same beam direction: sin(theta_2 - theta_1) is >= 0 or <= 0.
enum class RisleyBranch { positive, negative };

/// The angles off +z_L between which the boresight can be steered: an annulus if the inner one is above 0.
struct RisleyReach {
  double min_rad = 0;
  double max_rad = 0;
};

/// Closed forms for a pair of wedges and a beam that comes in along +z_L, in all four configurations
/// (docs/user/lidar/scanner-risley.md derives them). After prism 1 the beam is (m u(theta_1), w), after prism
/// 2 (m u(theta_1) + h sin(wedge_2) u(theta_2), z), u(a) = (cos a, sin a). m is constant; h is a function of
/// theta_2 - theta_1 in the forward problem and of the deflection alone in the inverse problem.
///
/// Directions only: thicknesses and gap shift the exit point and the ground point by up to 1.8 mm with the
/// default prisms.
class RisleySteering {
 public:
  /// `optics` must pass check().
  explicit RisleySteering(const RisleyOptics& optics);

  /// The direction of the boresight, to 1e-15; empty where a face reflects it totally.
  [[nodiscard]] std::optional<Direction<LidarFrame>> direction(const RisleyAngles& angles) const;
  /// The angles, in [-pi, pi], that steer the boresight along `aim`; empty where the aim lies outside the
  /// reach by more than 1e-15 rad. direction() reproduces the aim to 5e-15, and to 2e-15 / x at x rad before
  /// a grazing exit (reach()). Straight ahead, any common rotation of both prisms is a solution: the azimuth
  /// of the aim is taken as 0.
  [[nodiscard]] std::optional<RisleyAngles> angles(const Direction<LidarFrame>& aim,
                                                   RisleyBranch branch) const;
  /// Up to 90 deg, or up to the grazing exit where total reflection limits it; empty where the boresight is
  /// totally reflected at any rotation of the prisms.
  [[nodiscard]] std::optional<RisleyReach> reach() const;

 private:
  [[nodiscard]] std::optional<double> deflection(double theta_2_rad) const;
  /// h of the beam that leaves with `sine` across the axis and `cosine` along it.
  [[nodiscard]] double bend_at_tilted_face(double sine, double cosine) const;

  bool exit_is_tilted_;   // of prism 2
  double index_squared_;  // of prism 2
  double sine_;           // of prism 2's wedge
  double cosine_;
  double across_;  // m; NaN where prism 1 reflects the boresight totally
  double before_;  // the beam along z where it meets prism 2's tilted face, times the index there
};

}  // namespace landfall
