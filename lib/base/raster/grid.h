// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory/large_memory.h"
#include "base/raster/grid_spec.h"

namespace landfall {

/// One value per bin, row-major, y ascending.
template <class T>
class Grid {
 public:
  Grid() = default;
  explicit Grid(const GridSpec& spec, T fill = T{}) : spec_(spec), values_(spec.size(), fill) {}
  /// A grid whose values are not initialised: write all of them before reading any.
  [[nodiscard]] static Grid unset(const GridSpec& spec) {
    Grid grid;
    grid.spec_ = spec;
    grid.values_.resize(spec.size());
    return grid;
  }

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  /// The bin must lie in the grid.
  [[nodiscard]] const T& at(BinIndex bin) const { return values_[spec_.index(bin)]; }
  [[nodiscard]] T& at(BinIndex bin) { return values_[spec_.index(bin)]; }
  [[nodiscard]] std::span<const T> values() const { return values_; }
  [[nodiscard]] std::span<T> values() { return values_; }
  [[nodiscard]] std::span<const T> row(std::int64_t row) const {
    return values().subspan(static_cast<std::size_t>(row * spec_.cols), static_cast<std::size_t>(spec_.cols));
  }
  [[nodiscard]] std::span<T> row(std::int64_t row) {
    return values().subspan(static_cast<std::size_t>(row * spec_.cols), static_cast<std::size_t>(spec_.cols));
  }

 private:
  GridSpec spec_;
  std::vector<T, LargeAllocator<T>> values_;
};

/// The bins of `whole` in rows row .. row + rows - 1 and columns col .. col + cols - 1, at their own places.
[[nodiscard]] inline GridSpec part_of(const GridSpec& whole, BinIndex first, std::int64_t rows,
                                      std::int64_t cols) {
  return {whole.resolution_m, whole.first_row + first.row, whole.first_col + first.col, rows, cols};
}

/// Copies the values of the bins of `part`, which lie in the grid.
template <class T>
[[nodiscard]] Grid<T> cut_out(const Grid<T>& grid, const GridSpec& part) {
  auto result = Grid<T>::unset(part);
  const std::int64_t row = part.first_row - grid.spec().first_row;
  const std::int64_t col = part.first_col - grid.spec().first_col;
  for (std::int64_t r = 0; r < part.rows; ++r)
    std::copy_n(&grid.at({row + r, col}), part.cols, result.row(r).begin());
  return result;
}

/// Writes the values of a part into the bins of the grid, which holds them all.
template <class T>
void put_in(const Grid<T>& part, Grid<T>& grid) {
  const std::int64_t row = part.spec().first_row - grid.spec().first_row;
  const std::int64_t col = part.spec().first_col - grid.spec().first_col;
  for (std::int64_t r = 0; r < part.spec().rows; ++r)
    std::ranges::copy(part.row(r), &grid.at({row + r, col}));
}

}  // namespace landfall
