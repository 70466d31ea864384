// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D304
#include "campaign/pass_rate.h"

#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cassert>
#include <cmath>
#include <numbers>

namespace landfall {

ProbabilityInterval wilson(const PassRate& rate, double confidence) {
  assert(0 <= rate.k && rate.k <= rate.n && 0 < confidence && confidence < 1);
  if (rate.n == 0) return {0, 1};
  const double n = static_cast<double>(rate.n);
  const double passes = static_cast<double>(rate.k);
  const double fails = static_cast<double>(rate.n - rate.k);
  const double z = std::numbers::sqrt2 * boost::math::erf_inv(confidence);
  // (p + z^2/2n -+ z sqrt(p q/n + z^2/4n^2)) / (1 + z^2/n), multiplied by n.
  const double middle = passes + z * z / 2;
  const double half = z * std::sqrt(passes * fails / n + z * z / 4);
  return {rate.k == 0 ? 0 : (middle - half) / (n + z * z), fails == 0 ? 1 : (middle + half) / (n + z * z)};
}

double exact_lower_bound(const PassRate& rate, double confidence) {
  assert(0 <= rate.k && rate.k <= rate.n && 0 < confidence && confidence < 1);
  if (rate.k == 0) return 0;
  const double passes = static_cast<double>(rate.k);
  const double fails = static_cast<double>(rate.n - rate.k);
  // P(k or more of n pass) is the regularised incomplete beta function I_p(k, n - k + 1).
  return boost::math::ibeta_inv(passes, fails + 1, 1 - confidence);
}

}  // namespace landfall
