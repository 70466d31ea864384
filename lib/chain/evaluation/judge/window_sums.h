// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/raster/footprint.h"

namespace landfall {

/// A rectangle of values in memory.
template <class T>
struct View {
  T* first = nullptr;
  std::int64_t stride = 0;  ///< from one row to the next
  std::int64_t rows = 0;
  std::int64_t cols = 0;

  [[nodiscard]] T* row(std::int64_t row) const { return first + row * stride; }
  [[nodiscard]] T& at(std::int64_t row, std::int64_t col) const { return first[row * stride + col]; }
  /// The rectangle that begins at a place of this one.
  [[nodiscard]] View part(std::int64_t row, std::int64_t col, std::int64_t part_rows,
                          std::int64_t part_cols) const {
    return {&at(row, col), stride, part_rows, part_cols};
  }
  operator View<const T>() const { return {first, stride, rows, cols}; }  // NOLINT(*-explicit-*)
};

/// The sum of the values in each window: sums.at(r, c) is that of the window about values.at(r + i, c + j),
/// where i and j are half the number of rows and columns that `values` has more than `sums`. They are at most
/// footprint.half_bins(); a window is clipped to i rows and j columns on either side.
///
/// Sums of doubles have a rounding error: for R x C values of magnitude <= M, at most 4 R C (R + C) 2^-53 M.
/// For a square O(log(half_bins)) per window, for another footprint O(half_bins).
void window_sums(const View<const double>& values, const Footprint& footprint, const View<double>& sums);
/// Exact modulo 2^64, so that a value may hold several counts.
void window_sums(const View<const std::uint64_t>& values, const Footprint& footprint,
                 const View<std::uint64_t>& sums);

}  // namespace landfall
