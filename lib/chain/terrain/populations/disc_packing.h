// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

namespace landfall {

/// A disc on the ground, metres.
struct Disc {
  double x_m = 0;
  double y_m = 0;
  double radius_m = 1;

  /// Discs that touch do not overlap.
  [[nodiscard]] bool overlaps(const Disc& other) const {
    const double dx_m = x_m - other.x_m;
    const double dy_m = y_m - other.y_m;
    const double sum_m = radius_m + other.radius_m;
    return dx_m * dx_m + dy_m * dy_m < sum_m * sum_m;
  }
};

/// Discs that do not overlap each other. Radii within a factor of two share a hash grid: a query takes the
/// same time for any number of discs if large discs are added first.
class DiscPacking {
 public:
  /// Adds `disc` unless it overlaps an earlier one; its radius must be positive. Returns true if added.
  bool add_if_free(const Disc& disc);

 private:
  struct Level {
    double cell_m;
    double largest_m;  ///< no radius of the level is greater
    std::unordered_map<std::uint64_t, std::vector<Disc>> cells;
  };

  [[nodiscard]] static bool overlaps(const Level& level, const Disc& disc);

  std::map<int, Level> levels_;  ///< by the exponent of the radius
};

}  // namespace landfall
