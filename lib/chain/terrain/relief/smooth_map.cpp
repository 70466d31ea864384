// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/smooth_map.h"

#include <array>
#include <numbers>

#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

constexpr int kLargestDegree = 32;
using Polynomials = std::array<double, kLargestDegree + 1>;

Polynomials chebyshev(double u, int degree) {
  Polynomials t{1, u};
  for (int i = 2; i <= degree; ++i)
    t[static_cast<std::size_t>(i)] =
        2 * u * t[static_cast<std::size_t>(i - 1)] - t[static_cast<std::size_t>(i - 2)];
  return t;
}

/// The zeros of T_(degree + 1).
double node(int k, int degree) { return portable::cos(std::numbers::pi * (k + 0.5) / (degree + 1)); }

}  // namespace

SmoothMap::SmoothMap(const Function& function, double half_width, int degree)
    : half_width_(half_width), degree_(degree) {
  const auto count = static_cast<std::size_t>(degree + 1);
  std::vector<Polynomials> at_node;
  for (int k = 0; k <= degree; ++k) at_node.push_back(chebyshev(node(k, degree), degree));
  coefficients_.assign(count * count, Eigen::Vector2d::Zero());
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t l = 0; l < count; ++l) {
      const Eigen::Vector2d value = function({half_width * at_node[k][1], half_width * at_node[l][1]});
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j) {
          const double norm = (i == 0 ? 1 : 2) * (j == 0 ? 1 : 2);
          coefficients_[i * count + j] +=
              norm / static_cast<double>(count * count) * at_node[k][i] * at_node[l][j] * value;
        }
    }
}

Eigen::Vector2d SmoothMap::at(const Eigen::Vector2d& point) const {
  const Polynomials x = chebyshev(point.x() / half_width_, degree_);
  const Polynomials y = chebyshev(point.y() / half_width_, degree_);
  const auto count = static_cast<std::size_t>(degree_ + 1);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector2d row = Eigen::Vector2d::Zero();
    for (std::size_t j = 0; j < count; ++j) row += y[j] * coefficients_[i * count + j];
    sum += x[i] * row;
  }
  return sum;
}

bool SmoothMap::agrees(const Function& function, double tolerance) const {
  // The corners and centre of the square, and points that no set of nodes contains.
  for (const double u : {-1.0, -0.83, -0.41, 0.0, 0.27, 0.59, 1.0})
    for (const double v : {-1.0, -0.71, -0.13, 0.0, 0.37, 0.91, 1.0}) {
      const Eigen::Vector2d point(u * half_width_, v * half_width_);
      if (!((at(point) - function(point)).norm() <= tolerance)) return false;
    }
  return true;
}

std::optional<SmoothMap> SmoothMap::fitted(const Function& function, double half_width, double tolerance) {
  for (const int degree : {4, 8, 16, 32}) {
    SmoothMap map(function, half_width, degree);
    if (map.agrees(function, tolerance)) return map;
  }
  return std::nullopt;
}

}  // namespace landfall
