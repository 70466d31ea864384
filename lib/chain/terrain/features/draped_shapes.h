// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D108
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"
#include "chain/terrain/features/shape.h"

namespace landfall {

/// A ridge along its u axis (turned counter-clockwise from +x by yaw_rad), with one crest or two, like
/// Europa's double ridges. With d the distance across it, |v|, to the nearest crest (the crests lie at v =
/// +-spacing_m / 2):
///
///   height_m 2^(-(2 d / width_m)^2) taper(length_m / 2 - |u|, taper_m)
///     for |u| <= length_m / 2, d <= 3 width_m
///
/// a Gaussian whose full width at half height is width_m, with the smooth ends of shape.h. At the end of the
/// cross-section it has fallen to 2^-36 of the height. Between two crests the flanks meet in a V.
struct Ridge {
  static constexpr const char* kName = "ridge";
  static constexpr FeatureRole kRole = FeatureRole::drapes;

  double length_m = 100;
  double width_m = 10;
  double height_m = 3;
  double spacing_m = 0;  ///< between the crests; 0: a single one
  double taper_m = 10;   ///< length of each tapered end
  double yaw_rad = 0;

  /// Throws UsageError unless length, width and height are finite and positive, the spacing is finite and not
  /// negative, 0 <= taper_m <= length_m / 2 and the yaw is finite.
  void validate(const std::string& owner) const {
    require_positive({owner, "length_m"}, length_m);
    require_positive({owner, "width_m"}, width_m);
    require_positive({owner, "height_m"}, height_m);
    require_not_negative({owner, "spacing_m"}, spacing_m);
    require(taper_m >= 0 && taper_m <= length_m / 2, {owner, "taper_m"}, taper_m, "in [0, length_m / 2]");
    require_finite({owner, "yaw_rad"}, yaw_rad);
  }
  [[nodiscard]] double reach_m() const { return portable::hypot(length_m / 2, spacing_m / 2 + 3 * width_m); }
  /// The extent across is measured between the points at half height.
  [[nodiscard]] FeatureSize size() const {
    return FeatureSize::of_rectangle(length_m, spacing_m + width_m, height_m, yaw_rad);
  }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    return own_relief_m(TurnedAxes(yaw_rad).own(offset));
  }
  [[nodiscard]] double own_relief_m(const Offset& own) const {
    const double inside_m = length_m / 2 - std::abs(own.x_m);
    const double across = std::abs(std::abs(own.y_m) - spacing_m / 2) / width_m;
    if (!(inside_m >= 0) || across > 3) return kNoRelief;
    return height_m * portable::exp2(-4 * across * across) * taper(inside_m, taper_m);
  }
  friend bool operator==(const Ridge&, const Ridge&) = default;
};

/// Blades of ice along the u axis (turned counter-clockwise from +x by yaw_rad; 0: east-west, as Hobley et
/// al. 2018, Nature Geoscience 11, 901-904, expect near Europa's equator: 7.5 m apart and up to 15 m deep):
///
///   amplitude_m (1 - |2 frac(v' / wavelength_m) - 1|)^exponent edge,   v' = v + wobble_m n(u, v)
///
/// frac is the fractional part; exponent 1 gives a triangle, less is blunter with sharper troughs. n in [-1,
/// 1] is smooth noise: uniform values on a square lattice of wobble_length_m, functions of `seed` and the
/// lattice point only, interpolated by t^2 (3 - 2 t) along u and v. The field is a rectangle, length_m along
/// u and width_m along v, or a disc of diameter_m; `edge` is shape.h's taper over edge_m inside its border
/// (for a rectangle the product of the tapers along u and v).
struct PenitenteField {
  static constexpr const char* kName = "penitente_field";
  static constexpr FeatureRole kRole = FeatureRole::drapes;

  double length_m = 50;
  double width_m = 50;
  double diameter_m = 0;  ///< of a disc, with length_m and width_m 0; 0: a rectangle
  double amplitude_m = 1;
  double wavelength_m = 7.5;
  double exponent = 1;
  double edge_m = 7.5;
  double yaw_rad = 0;
  double wobble_m = 0;
  double wobble_length_m = 15;
  std::uint64_t seed = 1;

  /// Throws UsageError unless either the diameter or both length and width are positive and the other 0; the
  /// amplitude, wavelength and exponent are finite and positive; 0 <= edge_m <= half the least extent;
  /// wobble_m is finite and >= 0; the yaw is finite; and, for a wobble above 0, its length is finite and
  /// positive and the extent at most 1e9 times that length.
  void validate(const std::string& owner) const;
  [[nodiscard]] double reach_m() const;
  [[nodiscard]] FeatureSize size() const;
  [[nodiscard]] double relief_m(const Offset& offset) const;
  [[nodiscard]] double own_relief_m(const Offset& own) const;
  friend bool operator==(const PenitenteField&, const PenitenteField&) = default;

 private:
  /// The taper at a point in the field's own axes; negative outside.
  [[nodiscard]] double edge(const Offset& own) const;
  [[nodiscard]] double noise(const Offset& own) const;
};

}  // namespace landfall
