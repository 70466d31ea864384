// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

namespace landfall {

/// A position or a horizontal velocity in x and y of the DEM frame, metres or m/s.
struct Horizontal {
  double x = 0, y = 0;
  friend bool operator==(const Horizontal&, const Horizontal&) = default;
};

/// A bin (or node) by row and column. Row 0 is the southern row (lowest y), column 0 the lowest x.
struct BinIndex {
  std::int64_t row = 0;
  std::int64_t col = 0;
  friend bool operator==(const BinIndex&, const BinIndex&) = default;
};

/// A regular grid whose centres lie at integer multiples of the resolution. Only this struct defines where
/// bin (row, col) lies: x = (first_col + col) * resolution_m, y = (first_row + row) * resolution_m, metres,
/// frame D. Stored row-major, y ascending.
struct GridSpec {
  double resolution_m = 0;
  std::int64_t first_row = 0;
  std::int64_t first_col = 0;
  std::int64_t rows = 0;
  std::int64_t cols = 0;

  /// Centres from -half_width_m to +half_width_m inclusive. Throws UsageError unless the resolution is finite
  /// and positive, and half_width_m / resolution_m is a whole number >= 1 within 1e-9, and the grid has at
  /// most 2^30 values. `what` begins the message: "terrain.json: /grid".
  static GridSpec centered(double half_width_m, double resolution_m, const char* what = "grid");

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(rows * cols); }
  [[nodiscard]] double x(std::int64_t col) const {
    return static_cast<double>(first_col + col) * resolution_m;
  }
  [[nodiscard]] double y(std::int64_t row) const {
    return static_cast<double>(first_row + row) * resolution_m;
  }
  [[nodiscard]] bool contains(BinIndex bin) const {
    return bin.row >= 0 && bin.row < rows && bin.col >= 0 && bin.col < cols;
  }
  /// Row-major index; the bin must lie in the grid.
  [[nodiscard]] std::size_t index(BinIndex bin) const {
    return static_cast<std::size_t>(bin.row * cols + bin.col);
  }

  /// The bin whose centre is nearest, floor(x/s + 0.5) (half-open: a point on the edge belongs to the greater
  /// bin). It may lie outside the grid; a coordinate that is not finite or beyond +-2^62 bins gives a bin
  /// outside the grid.
  [[nodiscard]] BinIndex bin_of(double x_m, double y_m) const {
    return {nearest(y_m) - first_row, nearest(x_m) - first_col};
  }
  friend bool operator==(const GridSpec&, const GridSpec&) = default;

 private:
  [[nodiscard]] std::int64_t nearest(double coordinate_m) const {
    constexpr double kLimit = 0x1p61;
    const double bin = coordinate_m / resolution_m + 0.5;
    if (!(bin > -kLimit && bin < kLimit)) return INT64_MIN / 2;
    const auto cut = static_cast<std::int64_t>(bin);  // std::floor is a call on a generic processor
    return cut - (static_cast<double>(cut) > bin ? 1 : 0);
  }
};

/// "2,001 x 1,501 bins": columns, then rows.
[[nodiscard]] std::string size_text(const GridSpec& spec);

/// A rectangle about a centre, of which both are multiples of the resolution.
struct GridArea {
  std::array<double, 2> half_width_m;  ///< along x and y
  Horizontal center_m;
};

/// Bin centres from center_m - half_width_m to center_m + half_width_m inclusive, along x and along y. For a
/// square about the origin GridSpec::centered(), whose errors are those of each axis; throws UsageError also
/// for a centre that is not a whole multiple of the resolution within 1e-9 bins. `what` begins the message.
[[nodiscard]] GridSpec grid_over(const GridArea& area, double resolution_m, const char* what);

}  // namespace landfall
