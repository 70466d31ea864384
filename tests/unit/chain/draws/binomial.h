// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace landfall {

/// The pass probabilities of the tests.
inline constexpr std::array kProbabilities = {0.5, 0.7, 0.9, 0.95, 0.97, 0.99, 0.995, 0.999};

/// The probability of k passes in n draws, k = 0 .. n, by Pascal's rule from n = 0. Terms are positive, so
/// that each has a relative error of about n 2^-52.
inline std::vector<double> binomial(std::int64_t n, double p) {
  std::vector<double> mass = {1};
  for (std::int64_t draw = 0; draw < n; ++draw) {
    mass.push_back(0);
    for (std::size_t k = mass.size() - 1; k > 0; --k) mass[k] = (1 - p) * mass[k] + p * mass[k - 1];
    mass[0] *= 1 - p;
  }
  return mass;
}

/// The probability of k or more passes.
inline double upper_tail(std::int64_t k, const std::vector<double>& mass) {
  double sum = 0;
  for (auto i = static_cast<std::size_t>(k); i < mass.size(); ++i) sum += mass[i];
  return sum;
}

}  // namespace landfall
