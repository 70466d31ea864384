// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <variant>

namespace landfall {

/// The range of diameters of a population, metres.
struct DiameterRange {
  double min_m = 0;
  double max_m = 0;
  friend bool operator==(const DiameterRange&, const DiameterRange&) = default;
};

// Each law gives, for diameters D > 0 in metres,
//   density_per_m2(D)       N(>D), how many objects larger than D there are per square metre, which falls
//                           with D towards 0;
//   diameter_m(N, range)    its inverse: the D of the range that has N(>D) = N, within 1e-12 of D while N is
//                           a normal number; N must lie between the values at the range's ends;
//   area_fraction(range)    the share of the ground that the discs of these diameters cover where they do not
//                           overlap: the integral of pi D^2 / 4 dN;
//   validate(owner)         throws UsageError if a parameter is invalid.
// docs/reference/decisions.md, D112, D113.

/// N(>D) = coefficient D^-exponent, D in metres, N per square metre.
struct PowerLaw {
  double coefficient = 3e-4;
  double exponent = 2.482;

  /// Both must be finite and positive.
  void validate(const std::string& owner) const;
  [[nodiscard]] double density_per_m2(double diameter_m) const;
  [[nodiscard]] double diameter_m(double density_per_m2, const DiameterRange& range) const;
  [[nodiscard]] double area_fraction(const DiameterRange& range) const;
  friend bool operator==(const PowerLaw&, const PowerLaw&) = default;
};

/// Rocks of VIPER's environmental specification: typical, sparse, and at the rim of Haworth crater.
inline constexpr PowerLaw kViperRocks{3e-4, 2.482};
inline constexpr PowerLaw kLowBlockyRocks{1e-4, 1.75457};
inline constexpr PowerLaw kHaworthRocks{2e-3, 2.6607};
/// Craters in equilibrium, formed as fast as they are erased (Trask 1966); 10^-1.1 per square metre.
inline constexpr PowerLaw kTraskCraters{0.07943282347242814, 2};

/// Golombek and Rapp (1997): rocks of at least D cover the share F(D) = k exp(-q D) of the ground,
/// q = 1.79 + 0.152 / k per metre. Then N(>D) is the integral of 4 / (pi D^2) (-dF/dD), which is
/// (4 k q / pi) E_2(q D) / D with the exponential integral E_2.
struct GolombekLaw {
  double k = 0.05;

  /// The law by which rocks of at least diameter_m (>= 0) cover `area_fraction`, 0 < area_fraction <= 1.
  /// Throws UsageError, beginning with `owner`, if that needs k > 1.
  static GolombekLaw covering(double area_fraction, double diameter_m, const std::string& owner);

  /// k must lie in (0, 1].
  void validate(const std::string& owner) const;
  [[nodiscard]] double q_per_m() const { return 1.79 + 0.152 / k; }
  [[nodiscard]] double density_per_m2(double diameter_m) const;
  [[nodiscard]] double diameter_m(double density_per_m2, const DiameterRange& range) const;
  [[nodiscard]] double area_fraction(const DiameterRange& range) const;
  friend bool operator==(const GolombekLaw&, const GolombekLaw&) = default;
};

/// Craters of VIPER's environmental specification: as many per metre of diameter as N(>D) = 0.029174 D^-1.92
/// has up to 80 m, and 0.156228 D^-2.389 above. These formulas are discontinuous at 80 m, from 6.5e-6 to
/// 4.4e-6 per square metre. Here N(>D) is the sum over larger diameters: 0.156228 D^-2.389 from 80 m on, and
/// below 80 m the first formula minus the step, 2.0e-6 per square metre (docs/reference/decisions.md, D114).
struct ViperCraterLaw {
  void validate(const std::string& /*owner*/) const {}
  [[nodiscard]] double density_per_m2(double diameter_m) const;
  [[nodiscard]] double diameter_m(double density_per_m2, const DiameterRange& range) const;
  [[nodiscard]] double area_fraction(const DiameterRange& range) const;
  friend bool operator==(const ViperCraterLaw&, const ViperCraterLaw&) = default;
};

using SizeLaw = std::variant<PowerLaw, GolombekLaw, ViperCraterLaw>;

[[nodiscard]] double density_per_m2(const SizeLaw& law, double diameter_m);
[[nodiscard]] double diameter_m(const SizeLaw& law, double density_per_m2, const DiameterRange& range);
[[nodiscard]] double area_fraction(const SizeLaw& law, const DiameterRange& range);
void validate(const SizeLaw& law, const std::string& owner);

}  // namespace landfall
