// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/numerics/poisson.h"

#include <algorithm>
#include <cmath>

#include "base/numerics/elementary.h"

namespace landfall {
namespace {

double by_inversion(double mean, double uniform) {
  constexpr double kMax = 200;  // beyond it the distribution has no mass left for a mean below 16
  double probability = exponential(-mean);
  double sum = probability;
  double n = 0;
  while (sum <= uniform && n < kMax) {
    ++n;
    probability *= mean / n;
    sum += probability;
  }
  return n;
}

double by_expansion(double mean, double w) {
  const double square = w * w;
  const double root = std::sqrt(mean);
  const double n = mean + root * w + (2 + square) / 6 - w * (2 + square) / (72 * root) +
                   (3 * square * square + 7 * square - 16) / (810 * mean);
  return std::max(0.0, std::floor(n));
}

}  // namespace

double poisson_count(double mean, const PoissonDraw& draw) {
  return mean < kLargePoissonMean ? by_inversion(mean, draw.uniform) : by_expansion(mean, draw.normal);
}

}  // namespace landfall
