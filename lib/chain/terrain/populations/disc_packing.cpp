// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D115
#include "chain/terrain/populations/disc_packing.h"

#include <algorithm>
#include <cmath>

namespace landfall {
namespace {

std::int64_t cell_index(double coordinate_m, double cell_m) {
  return static_cast<std::int64_t>(std::floor(coordinate_m / cell_m));
}

/// Cells with equal keys share a list, which costs time but affects no result.
std::uint64_t key_of(std::int64_t col, std::int64_t row) {
  return static_cast<std::uint64_t>(col) * 0x9e3779b97f4a7c15U ^
         static_cast<std::uint64_t>(row) * 0xc2b2ae3d27d4eb4fU;
}

}  // namespace

bool DiscPacking::overlaps(const Level& level, const Disc& disc) {
  const double reach_m = disc.radius_m + level.largest_m;
  const std::int64_t last_row = cell_index(disc.y_m + reach_m, level.cell_m);
  const std::int64_t last_col = cell_index(disc.x_m + reach_m, level.cell_m);
  for (std::int64_t row = cell_index(disc.y_m - reach_m, level.cell_m); row <= last_row; ++row)
    for (std::int64_t col = cell_index(disc.x_m - reach_m, level.cell_m); col <= last_col; ++col) {
      const auto cell = level.cells.find(key_of(col, row));
      if (cell == level.cells.end()) continue;
      if (std::ranges::any_of(cell->second, [&](const Disc& other) { return disc.overlaps(other); }))
        return true;
    }
  return false;
}

bool DiscPacking::add_if_free(const Disc& disc) {
  for (const auto& entry : levels_)
    if (overlaps(entry.second, disc)) return false;
  const int exponent = std::ilogb(disc.radius_m);
  const double largest_m = std::ldexp(1, exponent + 1);
  Level& level = levels_.try_emplace(exponent, Level{2 * largest_m, largest_m, {}}).first->second;
  level.cells[key_of(cell_index(disc.x_m, level.cell_m), cell_index(disc.y_m, level.cell_m))].push_back(disc);
  return true;
}

}  // namespace landfall
