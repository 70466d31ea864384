// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D95
#include "detector/distortion.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace landfall {
namespace {

/// The derivative of r factor(r^2), at s = r^2.
double growth(const RadialDistortion& d, double s) {
  return 1 + s * (3 * d.k1 + s * (5 * d.k2 + s * 7 * d.k3));
}

/// The points in [0, limit] at which growth() is stationary: the roots of 3 k1 + 10 k2 s + 21 k3 s^2, and
/// both ends.
std::array<double, 4> turning_points(const RadialDistortion& d, double limit) {
  const double a = 21 * d.k3;
  const double half_b = 5 * d.k2;
  const double c = 3 * d.k1;
  // This form avoids cancellation: one root is q/a, the other c/q.
  const double root = std::sqrt(std::max(half_b * half_b - a * c, 0.0));
  const double q = -(half_b + std::copysign(root, half_b));
  const auto inside = [limit](double s) { return s > 0 && s < limit ? s : 0.0; };
  std::array<double, 4> points = {0, inside(q / a), inside(c / q), limit};
  std::sort(points.begin(), points.end());
  return points;
}

/// The root of growth() where it falls from positive at `low` to not positive at `high`.
double falling_root(const RadialDistortion& d, double low, double high) {
  for (double middle = (low + high) / 2; middle > low && middle < high; middle = (low + high) / 2)
    (growth(d, middle) > 0 ? low : high) = middle;
  return high;
}

}  // namespace

std::optional<double> fold_radius(const RadialDistortion& distortion, double radius) {
  const std::array<double, 4> s = turning_points(distortion, radius * radius);
  for (std::size_t i = 1; i < s.size(); ++i)
    if (!(growth(distortion, s[i]) > 0)) return std::sqrt(falling_root(distortion, s[i - 1], s[i]));
  return std::nullopt;
}

}  // namespace landfall
