// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/mesh/orient2d.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "base/numerics/exact_arithmetic.h"

namespace landfall {
namespace {

/// An exact sum of up to 16 numbers as components of increasing size that do not overlap, so that the last
/// non-zero component has the sign of the sum.
class Expansion {
 public:
  void add(double term) {
    for (std::size_t i = 0; i < size_; ++i) {
      const ExactPair step = exact_sum(term, components_.at(i));
      components_.at(i) = step.rest;
      term = step.value;
    }
    components_.at(size_++) = term;
  }

  void add_product(const ExactPair& a, const ExactPair& b, double sign) {
    for (const double x : {a.value, a.rest})
      for (const double y : {b.value, b.rest}) {
        const ExactPair term = exact_product(sign * x, y);
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
  determinant.add_product(exact_sum(a.x(), -c.x()), exact_sum(b.y(), -c.y()), 1);
  determinant.add_product(exact_sum(a.y(), -c.y()), exact_sum(b.x(), -c.x()), -1);
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
