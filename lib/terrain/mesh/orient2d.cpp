// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/mesh/orient2d.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace landfall {
namespace {

/// An unevaluated sum of a rounded value and its rounding error.
struct Exact {
  double value;
  double rest;
};

Exact sum(double a, double b) {
  const double value = a + b;
  const double b_part = value - a;
  return {value, (a - (value - b_part)) + (b - b_part)};
}

Exact product(double a, double b) {
  const double value = a * b;
  return {value, std::fma(a, b, -value)};
}

/// An exact sum of up to 16 numbers as components of increasing size that do not overlap, so that the last
/// non-zero component has the sign of the sum.
class Expansion {
 public:
  void add(double term) {
    for (std::size_t i = 0; i < size_; ++i) {
      const Exact step = sum(term, components_.at(i));
      components_.at(i) = step.rest;
      term = step.value;
    }
    components_.at(size_++) = term;
  }

  void add_product(const Exact& a, const Exact& b, double sign) {
    for (const double x : {a.value, a.rest})
      for (const double y : {b.value, b.rest}) {
        const Exact term = product(sign * x, y);
        add(term.rest);
        add(term.value);
      }
  }

  [[nodiscard]] double value() const {
    double total = 0;
    for (std::size_t i = 0; i < size_; ++i) total += components_.at(i);
    return total;
  }

 private:
  std::array<double, 16> components_{};
  std::size_t size_ = 0;
};

double exact_orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  Expansion determinant;
  determinant.add_product(sum(a.x(), -c.x()), sum(b.y(), -c.y()), 1);
  determinant.add_product(sum(a.y(), -c.y()), sum(b.x(), -c.x()), -1);
  return determinant.value();
}

}  // namespace

double orient2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  // Rounding errs by less than 4 units of 2^-53; a value above 2^22 of those is also accurate to 2^-20.
  constexpr double kBound = 4 * 0x1p-53 * 0x1p22;
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double value = left - right;
  if (std::abs(value) > kBound * (std::abs(left) + std::abs(right))) return value;
  return exact_orientation(a, b, c);
}

}  // namespace landfall
