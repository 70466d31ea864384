// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D304
#include "chain/draws/pass_rate.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cassert>
#include <cmath>
#include <numbers>

namespace landfall {
namespace {

/// The correlation of the pairs with Newcombe's continuity correction.
double corrected_phi(const PairedCounts& counts) {
  const auto a = static_cast<double>(counts.both);
  const auto b = static_cast<double>(counts.only_a);
  const auto c = static_cast<double>(counts.only_b);
  const auto d = static_cast<double>(counts.neither);
  const double margins = (a + b) * (c + d) * (a + c) * (b + d);
  if (margins == 0) return 0;
  const double covariance = a * d - b * c;
  const double corrected = covariance > 0 ? std::max(covariance - (a + b + c + d) / 2, 0.0) : covariance;
  return corrected / std::sqrt(margins);
}

/// The length of the third side of a triangle whose sides x and y enclose an angle of cosine phi.
double third_side(double x, double y, double phi) {
  return std::sqrt(std::max(x * x - 2 * phi * x * y + y * y, 0.0));
}

}  // namespace

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

PairedCounts paired_counts(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  PairedCounts counts;
  for (std::size_t i = 0; i < a.size(); ++i)
    ++(a[i] == 1 ? (b[i] == 1 ? counts.both : counts.only_a) : (b[i] == 1 ? counts.only_b : counts.neither));
  return counts;
}

double mcnemar_p(const PairedCounts& counts) {
  assert(counts.only_a >= 0 && counts.only_b >= 0);
  if (counts.only_a == counts.only_b) return 1;
  const auto fewer = static_cast<double>(std::min(counts.only_a, counts.only_b));
  const auto more = static_cast<double>(std::max(counts.only_a, counts.only_b));
  // P(at most k of n) of fair coins is I_1/2(n - k, k + 1).
  return std::min(1.0, 2 * boost::math::ibeta(more, fewer + 1, 0.5));
}

ProbabilityDifference newcombe_difference(const PairedCounts& counts, double confidence) {
  const std::int64_t pairs = counts.pairs();
  if (pairs == 0) return {};
  const auto n = static_cast<double>(pairs);
  const double p_a = static_cast<double>(counts.rate_a().k) / n;
  const double p_b = static_cast<double>(counts.rate_b().k) / n;
  const ProbabilityInterval a = wilson(counts.rate_a(), confidence);
  const ProbabilityInterval b = wilson(counts.rate_b(), confidence);
  const double phi = corrected_phi(counts);
  const double value = static_cast<double>(counts.only_a - counts.only_b) / n;
  return {value, value - third_side(p_a - a.low, b.high - p_b, phi),
          value + third_side(a.high - p_a, p_b - b.low, phi)};
}

}  // namespace landfall
