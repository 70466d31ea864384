// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

namespace lander {

/// The host's scene: the surface of a terrain.h5, whose cells are split along the diagonal from (i + 1, j) to
/// (i, j + 1), as landfall defines it.
class Heightfield {
 public:
  /// z[row * columns + column]; row 0 has the lowest y.
  Heightfield(std::array<double, 2> corner_m, double step_m, int columns, std::vector<double> z_m);

  /// Metres along the unit vector to the first hit from above; NaN if there is none, or if the ray does not
  /// descend, or is beside the terrain where it passes the height of the highest point.
  [[nodiscard]] double range_m(const std::array<double, 3>& origin_m,
                               const std::array<double, 3>& direction) const;

 private:
  struct Walk;
  /// The height of the surface at (u, v), in steps from the corner, on a triangle of cell (column, row).
  [[nodiscard]] double height(int column, int row, bool upper, double u, double v) const;

  std::array<double, 2> corner_m_;
  double step_m_;
  int columns_, rows_;
  std::vector<double> z_m_;
  double lowest_m_, highest_m_;
};

}  // namespace lander
