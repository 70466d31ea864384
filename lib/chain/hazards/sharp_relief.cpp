// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D464
#include "chain/hazards/sharp_relief.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <vector>

namespace landfall {
namespace {

/// The sum of z over `size` x `size` bins from (row, col).
double block_sum(const Grid<double>& z, std::int64_t size, std::int64_t row, std::int64_t col) {
  double sum = 0;
  for (std::int64_t r = row; r < row + size; ++r)
    for (std::int64_t c = col; c < col + size; ++c) sum += z.at({r, c});
  return sum;
}

/// The share of the sharpest hundredth of the blocks of `size` x `size` bins; 0 of level terrain.
double sharp_share(const Grid<double>& z, const BinMask& region, std::int64_t size) {
  std::vector<double> squares;
  for (std::int64_t row = size; row + 2 * size <= z.spec().rows; row += size)
    for (std::int64_t col = size; col + 2 * size <= z.spec().cols; col += size) {
      if (region.at({row, col}) == 0) continue;
      const double beside = block_sum(z, size, row - size, col) + block_sum(z, size, row + size, col) +
                            block_sum(z, size, row, col - size) + block_sum(z, size, row, col + size);
      const double curvature = block_sum(z, size, row, col) - beside / 4;
      if (!std::isnan(curvature)) squares.push_back(curvature * curvature);
    }
  const auto sharpest = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 100);
  std::nth_element(squares.begin(), sharpest, squares.end(), std::greater<>());
  const double all = std::accumulate(squares.begin(), squares.end(), 0.0);
  return all > 0 ? std::accumulate(squares.begin(), sharpest, 0.0) / all : 0;
}

}  // namespace

bool has_sharp_relief(const Grid<double>& z, const BinMask& region) {
  constexpr double kSharp = 1.0 / 6;
  return sharp_share(z, region, 1) > kSharp || sharp_share(z, region, 2) > kSharp;
}

}  // namespace landfall
