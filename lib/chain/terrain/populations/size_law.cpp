// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D113, D114
#include "chain/terrain/populations/size_law.h"

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

/// The integral of D^power from range.min_m to range.max_m.
double power_integral(double power, const DiameterRange& range) {
  const double p = power + 1;
  const double octaves = portable::log(range.max_m / range.min_m);
  return portable::pow(range.min_m, p) * (p == 0 ? octaves : portable::expm1(p * octaves) / p);
}

constexpr double kViperBreak_m = 80;
constexpr PowerLaw kViperSmall{29174e-6, 1.92};
constexpr PowerLaw kViperLarge{156228e-6, 2.389};

double viper_leap() {
  return kViperSmall.density_per_m2(kViperBreak_m) - kViperLarge.density_per_m2(kViperBreak_m);
}

}  // namespace

void PowerLaw::validate(const std::string& owner) const {
  require_positive({owner, "coefficient"}, coefficient);
  require_positive({owner, "exponent"}, exponent);
}

double PowerLaw::density_per_m2(double diameter_m) const {
  return coefficient * portable::pow(diameter_m, -exponent);
}

double PowerLaw::diameter_m(double density_per_m2, const DiameterRange& range) const {
  const double diameter_m = portable::pow(coefficient / density_per_m2, 1 / exponent);
  return std::clamp(diameter_m, range.min_m, range.max_m);
}

double PowerLaw::area_fraction(const DiameterRange& range) const {
  return std::numbers::pi / 4 * coefficient * exponent * power_integral(1 - exponent, range);
}

GolombekLaw GolombekLaw::covering(double area_fraction, double diameter_m, const std::string& owner) {
  // log F(D) = log k - (1.79 + 0.152 / k) D rises with k.
  const auto excess = [&](double abundance) {
    return portable::log(abundance / area_fraction) - GolombekLaw{abundance}.q_per_m() * diameter_m;
  };
  if (!(excess(1) >= 0))
    throw UsageError(owner + ": rocks of " + number_text(diameter_m) + " m and more cover at most " +
                     number_text(portable::exp(-GolombekLaw{1}.q_per_m() * diameter_m)) +
                     " of the ground by this model (k = 1), not " + number_text(area_fraction));
  std::uintmax_t steps = 200;
  const auto bracket = boost::math::tools::bisect(excess, area_fraction, 1.0,
                                                  boost::math::tools::eps_tolerance<double>(50), steps);
  return {std::midpoint(bracket.first, bracket.second)};
}

void GolombekLaw::validate(const std::string& owner) const {
  require(k > 0 && k <= 1, {owner, "k"}, k, "in (0, 1]");
}

double GolombekLaw::density_per_m2(double diameter_m) const {
  const double q = q_per_m();
  return 4 * k * q / std::numbers::pi * portable::exponential_integral_2(q * diameter_m) / diameter_m;
}

double GolombekLaw::diameter_m(double density_per_m2, const DiameterRange& range) const {
  constexpr double kMin = 1e-300;  // where N(>D) underflows
  const auto excess = [&](double diameter_m) {
    return portable::log(std::max(this->density_per_m2(diameter_m), kMin) / density_per_m2);
  };
  // If rounding has moved the root outside the range, it is the nearest end.
  const double at_min = std::max(excess(range.min_m), 0.0);
  const double at_max = std::min(excess(range.max_m), 0.0);
  std::uintmax_t steps = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      excess, range.min_m, range.max_m, at_min, at_max, boost::math::tools::eps_tolerance<double>(50), steps);
  return std::midpoint(bracket.first, bracket.second);
}

double GolombekLaw::area_fraction(const DiameterRange& range) const {
  const double q = q_per_m();
  return k * portable::exp(-q * range.min_m) * -portable::expm1(-q * (range.max_m - range.min_m));
}

double ViperCraterLaw::density_per_m2(double diameter_m) const {
  if (diameter_m >= kViperBreak_m) return kViperLarge.density_per_m2(diameter_m);
  return kViperSmall.density_per_m2(diameter_m) - viper_leap();
}

double ViperCraterLaw::diameter_m(double density_per_m2, const DiameterRange& range) const {
  if (density_per_m2 <= kViperLarge.density_per_m2(kViperBreak_m))
    return kViperLarge.diameter_m(density_per_m2, range);
  return kViperSmall.diameter_m(density_per_m2 + viper_leap(), range);
}

double ViperCraterLaw::area_fraction(const DiameterRange& range) const {
  const double middle_m = std::clamp(kViperBreak_m, range.min_m, range.max_m);
  return kViperSmall.area_fraction({range.min_m, middle_m}) +
         kViperLarge.area_fraction({middle_m, range.max_m});
}

double density_per_m2(const SizeLaw& law, double diameter_m) {
  return std::visit([&](const auto& l) { return l.density_per_m2(diameter_m); }, law);
}

double diameter_m(const SizeLaw& law, double density_per_m2, const DiameterRange& range) {
  return std::visit([&](const auto& l) { return l.diameter_m(density_per_m2, range); }, law);
}

double area_fraction(const SizeLaw& law, const DiameterRange& range) {
  return std::visit([&](const auto& l) { return l.area_fraction(range); }, law);
}

void validate(const SizeLaw& law, const std::string& owner) {
  std::visit([&](const auto& l) { l.validate(owner); }, law);
}

}  // namespace landfall
