// SPDX-License-Identifier: GPL-3.0-or-later
#include "heightfield.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lander {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kMiss = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Heightfield::Heightfield(std::array<double, 2> corner_m, double step_m, int columns, std::vector<double> z_m)
    : corner_m_(corner_m),
      step_m_(step_m),
      columns_(columns),
      rows_(static_cast<int>(z_m.size()) / columns),
      z_m_(std::move(z_m)),
      lowest_m_(*std::min_element(z_m_.begin(), z_m_.end())),
      highest_m_(*std::max_element(z_m_.begin(), z_m_.end())) {}

double Heightfield::height(int column, int row, bool upper, double u, double v) const {
  const double* corner = &z_m_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                               static_cast<std::size_t>(column)];
  const double east = corner[1], north = corner[columns_];
  const double a = u - column, b = v - row;
  if (upper)
    return corner[columns_ + 1] + (1 - a) * (north - corner[columns_ + 1]) +
           (1 - b) * (east - corner[columns_ + 1]);
  return corner[0] + a * (east - corner[0]) + b * (north - corner[0]);
}

/// A ray in steps of the grid, cell by cell.
struct Heightfield::Walk {
  double u0, v0, du, dv;  // u = u0 + t du
  int column, row;

  [[nodiscard]] double u(double t) const { return u0 + t * du; }
  [[nodiscard]] double v(double t) const { return v0 + t * dv; }
  [[nodiscard]] double side_column() const {
    return du > 0 ? (column + 1 - u0) / du : du < 0 ? (column - u0) / du : kInfinite;
  }
  [[nodiscard]] double side_row() const {
    return dv > 0 ? (row + 1 - v0) / dv : dv < 0 ? (row - v0) / dv : kInfinite;
  }
  [[nodiscard]] double diagonal() const {
    const double sum = du + dv;
    return sum != 0 ? (column + row + 1 - u0 - v0) / sum : kInfinite;
  }
  void next() {
    if (side_column() < side_row())
      column += du > 0 ? 1 : -1;
    else
      row += dv > 0 ? 1 : -1;
  }
};

double Heightfield::range_m(const std::array<double, 3>& origin_m,
                            const std::array<double, 3>& direction) const {
  if (!(direction[2] < 0)) return kMiss;
  Walk walk{(origin_m[0] - corner_m_[0]) / step_m_,
            (origin_m[1] - corner_m_[1]) / step_m_,
            direction[0] / step_m_,
            direction[1] / step_m_,
            0,
            0};
  double t = std::max(0.0, (highest_m_ - origin_m[2]) / direction[2]);
  const double end = (lowest_m_ - 1 - origin_m[2]) / direction[2];
  walk.column = static_cast<int>(std::floor(walk.u(t)));
  walk.row = static_cast<int>(std::floor(walk.v(t)));
  while (t < end && walk.column >= 0 && walk.column < columns_ - 1 && walk.row >= 0 && walk.row < rows_ - 1) {
    const double leave = std::min({walk.side_column(), walk.side_row(), end}), split = walk.diagonal();
    const bool crosses = split > t && split < leave;
    // Along a part on one triangle the height above the surface is linear. The surface is continuous, so a
    // ray cannot pass between two parts.
    for (const auto& [first, last] : {std::pair{t, crosses ? split : leave}, std::pair{split, leave}}) {
      const double middle = (first + last) / 2;
      const bool upper = walk.u(middle) - walk.column + walk.v(middle) - walk.row > 1;
      const auto above = [&](double s) {
        return origin_m[2] + s * direction[2] - height(walk.column, walk.row, upper, walk.u(s), walk.v(s));
      };
      if (const double below = above(last); below <= 0) {
        const double start = std::max(above(first), 0.0);
        return start > below ? first + (last - first) * start / (start - below) : first;
      }
      if (!crosses) break;
    }
    t = leave;
    walk.next();
  }
  return kMiss;
}

}  // namespace lander
