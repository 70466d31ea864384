// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <variant>
#include <vector>

#include "base/raster/polygon.h"

namespace landfall {

/// The state of a lander that begins its divert, and its thrust.
struct DivertStart {
  double height_m = 0;      ///< above the ground, > 0
  double descent_mps = 0;   ///< downward, > 0
  Horizontal velocity_mps;  ///< at the start
  Horizontal position_m;    ///< at the start
  double tilt_rad = 0;      ///< largest angle of the thrust from the vertical, in [0, pi/2)
  double thrust_accel_mps2 = 0;
  double gravity_mps2 = 0;
};

/// The places among which landing sites are looked for. A border belongs to its area, to 1e-9 m.
class ReachableArea {
 public:
  /// The circle about the origin; radius_m > 0.
  [[nodiscard]] static ReachableArea circle(double radius_m);

  /// The inside of a polygon by the even-odd rule, so that edges may cross. At least 3 vertices, in either
  /// direction; the last one is joined to the first.
  [[nodiscard]] static ReachableArea polygon(std::vector<Horizontal> vertices);

  /// An inner bound of the places at which the lander can come to rest, h above which it begins at the speed
  /// w. It brakes uniformly for T = 2 h/w, with the vertical thrust a_z = g + w^2/2h. What remains is a
  /// horizontal acceleration of b = min(a_z tan tilt, sqrt(a^2 - a_z^2)), kept constant over each half of T.
  /// The places lie within b T^2/4 of position + v T/4 and of position + 3 v T/4; there are none if |v| > b
  /// T. Throws UsageError "thrust_accel_mps2: ..." if a_z > a.
  [[nodiscard]] static ReachableArea divert(const DivertStart& start);

  [[nodiscard]] bool contains(Horizontal place) const;

  /// The vertices of the border, open; a curved one is sampled within 0.1 % of its radius. Empty if no place
  /// is reachable.
  [[nodiscard]] std::vector<Horizontal> outline() const;

 private:
  /// The places within radius_m of both centres.
  struct Lens {
    std::array<Horizontal, 2> centres;
    double radius_m;
  };
  explicit ReachableArea(std::variant<Lens, Polygon> shape);
  [[nodiscard]] static std::vector<Horizontal> outline_of(const Lens& lens);

  std::variant<Lens, Polygon> shape_;
};

}  // namespace landfall
