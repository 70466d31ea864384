// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <type_traits>

#include "base/raster/grid.h"

namespace landfall {

/// The bins of some rows and columns, row after row: for (const auto [row, col] : bins_of(spec)).
class Bins {
 public:
  /// From `first` to before the row and the column of `end`, which lie beyond those of `first`.
  constexpr Bins(BinIndex first, BinIndex end) : first_(first), end_(end) {}

  struct Iterator {
    BinIndex bin;
    std::int64_t first_col, end_col;

    constexpr BinIndex operator*() const { return bin; }
    constexpr Iterator& operator++() {
      if (++bin.col == end_col) bin = {bin.row + 1, first_col};
      return *this;
    }
    friend constexpr bool operator==(const Iterator& a, const Iterator& b) { return a.bin == b.bin; }
  };
  [[nodiscard]] constexpr Iterator begin() const { return {first_, first_.col, end_.col}; }
  [[nodiscard]] constexpr Iterator end() const { return {{end_.row, first_.col}, first_.col, end_.col}; }

 private:
  BinIndex first_, end_;
};

/// The bins of a grid, a tile or a picture.
template <class Shape>
Bins bins_of(const Shape& shape) {
  return {{0, 0}, {shape.rows, shape.cols}};
}

/// The grid with these values, row after row.
template <class T = double>
Grid<T> grid_with(const GridSpec& spec, std::initializer_list<std::type_identity_t<T>> values) {
  Grid<T> grid(spec);
  std::copy(values.begin(), values.end(), grid.values().begin());
  return grid;
}

/// One row of bins of 1 m.
template <class T = double>
Grid<T> row_with(std::initializer_list<std::type_identity_t<T>> values) {
  return grid_with<T>({1, 0, 0, 1, static_cast<std::int64_t>(values.size())}, values);
}

/// A grid of value(x_m, y_m) at the centres of its bins.
template <class T = double, class Value>
Grid<T> grid_of(const GridSpec& spec, const Value& value) {
  Grid<T> grid(spec);
  for (const BinIndex bin : bins_of(spec))
    grid.at(bin) = static_cast<T>(value(spec.x(bin.col), spec.y(bin.row)));
  return grid;
}

}  // namespace landfall
