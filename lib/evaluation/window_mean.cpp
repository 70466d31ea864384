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

constexpr std::size_t kRowsPerPiece = 128;

/// One row as the sums want it.
struct Row {
  explicit Row(std::size_t cols) : values(cols), valid(cols), sums(cols), counts(cols) {}
  std::vector<double> values;       ///< NaN as +0
  std::vector<std::int32_t> valid;  ///< 1, NaN as 0
  std::vector<double> sums;
  std::vector<std::int32_t> counts;
};

void read_row(std::span<const double> in, Row& row) {
  for (std::size_t c = 0; c < in.size(); ++c) {
    row.valid[c] = std::isnan(in[c]) ? 0 : 1;
    row.values[c] = std::isnan(in[c]) ? 0.0 : in[c];
  }
}

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

template <class T>
void add_to(std::span<const T> values, std::span<T> sums) {
  T* const target = sums.data();
  for (std::size_t c = 0; c < values.size(); ++c) target[c] += values[c];
}

struct RowRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

/// The windows centred on some rows. Each row that they reach is summed once and added to the windows that
/// hold it, from the lowest row up.
void sum_windows(const Grid<double>& values, std::int64_t half, const RowRange& centres,
                 WindowMeans& result) {
  Row row(static_cast<std::size_t>(values.spec().cols));
  const std::int64_t last = std::min(centres.end - 1 + half, values.spec().rows - 1);
  for (std::int64_t r = std::max<std::int64_t>(centres.begin - half, 0); r <= last; ++r) {
    read_row(values.row(r), row);
    sum_along_row<double>(row.values, half, row.sums);
    sum_along_row<std::int32_t>(row.valid, half, row.counts);
    const RowRange holding{std::max(r - half, centres.begin), std::min(r + half + 1, centres.end)};
    for (std::int64_t centre = holding.begin; centre < holding.end; ++centre) {
      add_to<double>(row.sums, result.mean.row(centre));
      add_to<std::int32_t>(row.counts, result.count.row(centre));
    }
  }
}

void divide(const RowRange& centres, WindowMeans& result) {
  for (std::int64_t row = centres.begin; row < centres.end; ++row) {
    const std::span<double> mean = result.mean.row(row);
    const std::span<std::int32_t> count = result.count.row(row);
    for (std::size_t c = 0; c < mean.size(); ++c)
      mean[c] = count[c] == 0 ? std::numeric_limits<double>::quiet_NaN() : mean[c] / count[c];
  }
}

}  // namespace

WindowMeans window_means(const Grid<double>& values, std::int64_t half_bins) {
  const GridSpec& spec = values.spec();
  WindowMeans result{Grid<double>(spec), Grid<std::int32_t>(spec)};
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    const RowRange centres{static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end)};
    sum_windows(values, half_bins, centres, result);
    divide(centres, result);
  });
  return result;
}

}  // namespace landfall
