// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "terrain/features/feature_role.h"

namespace landfall {

/// Blades of ice along the u axis (turned counter-clockwise from +x by yaw_rad; 0: east-west, as Hobley et
/// al. 2018, Nature Geoscience 11, 901-904, expect near Europa's equator: 7.5 m apart and up to 15 m deep):
///
///   amplitude_m (1 - |2 frac(v' / wavelength_m) - 1|)^exponent edge,   v' = v + wobble_m n(u, v)
///
/// frac is the fractional part; exponent 1 gives a triangle, less is blunter with sharper troughs. n in [-1,
/// 1] is smooth noise: uniform values on a square lattice of wobble_length_m, functions of `seed` and the
/// lattice point only, interpolated by t^2 (3 - 2 t) along u and v. The field is a rectangle, length_m along
/// u and width_m along v, or a disc of diameter_m; `edge` is taper.h's taper over edge_m inside its border
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
