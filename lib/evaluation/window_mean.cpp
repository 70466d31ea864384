// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/window_mean.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "base/parallel.h"

namespace landfall {
namespace {

constexpr std::size_t kRowsPerPiece = 16;

/// sums[c] = the values of columns c - half .. c + half, added left to right. The offset is the outer loop:
/// each sum keeps its order and the inner loop runs over neighbours.
template <class T>
void sum_along_row(std::span<const T> values, std::int64_t half, std::span<T> sums) {
  const std::int64_t cols = std::ssize(values);
  const std::int64_t reach = std::min(half, cols - 1);
  std::ranges::fill(sums, T{});
  for (std::int64_t offset = -reach; offset <= reach; ++offset) {
    const std::int64_t begin = std::max<std::int64_t>(0, -offset);
    const std::int64_t end = std::min(cols, cols - offset);
    const T* const shifted = values.data() + offset;
    for (std::int64_t c = begin; c < end; ++c) sums.data()[c] += shifted[c];
  }
}

/// The same along columns: sums of rows row - half .. row + half, from the lowest up.
template <class T>
void sum_along_columns(const Grid<T>& rows, std::int64_t row, std::int64_t half, std::span<T> sums) {
  const std::int64_t last = std::min(row + half, rows.spec().rows - 1);
  std::ranges::fill(sums, T{});
  for (std::int64_t r = std::max<std::int64_t>(row - half, 0); r <= last; ++r) {
    const T* const values = rows.row(r).data();
    for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += values[c];
  }
}

void sum_rows(const Grid<double>& values, std::int64_t half, WindowMeans& sums) {
  const auto cols = static_cast<std::size_t>(values.spec().cols);
  const auto piece = [&](std::size_t begin, std::size_t end) {
    std::vector<double> value(cols);
    std::vector<std::int32_t> valid(cols);
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row) {
      const std::span<const double> in = values.row(row);
      for (std::size_t c = 0; c < cols; ++c) {
        valid[c] = std::isnan(in[c]) ? 0 : 1;
        value[c] = std::isnan(in[c]) ? 0.0 : in[c];
      }
      sum_along_row<double>(value, half, sums.mean.row(row));
      sum_along_row<std::int32_t>(valid, half, sums.count.row(row));
    }
  };
  parallel_for(static_cast<std::size_t>(values.spec().rows), kRowsPerPiece, piece);
}

}  // namespace

WindowMeans window_means(const Grid<double>& values, std::int64_t half_bins) {
  const GridSpec& spec = values.spec();
  WindowMeans row_sums{Grid<double>(spec), Grid<std::int32_t>(spec)};
  sum_rows(values, half_bins, row_sums);
  WindowMeans result{Grid<double>(spec), Grid<std::int32_t>(spec)};
  const auto piece = [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row) {
      const std::span<double> mean = result.mean.row(row);
      const std::span<std::int32_t> count = result.count.row(row);
      sum_along_columns(row_sums.mean, row, half_bins, mean);
      sum_along_columns(row_sums.count, row, half_bins, count);
      for (std::size_t c = 0; c < mean.size(); ++c)
        mean[c] = count[c] == 0 ? std::numeric_limits<double>::quiet_NaN() : mean[c] / count[c];
    }
  };
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerPiece, piece);
  return result;
}

}  // namespace landfall
