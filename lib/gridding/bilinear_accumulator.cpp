// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D52
#include "gridding/bilinear_accumulator.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "gridding/nearest_bins.h"

namespace landfall {
namespace {

/// A coordinate relative to the bin centres: the last centre at or before it, and its offset in [0, 1).
struct CentrePair {
  std::int64_t before;
  double fraction;
};

CentrePair centres_around(double coordinate_m, double resolution_m, std::int64_t first) {
  constexpr double kLimit = 0x1p61;
  const double steps = coordinate_m / resolution_m;
  const double whole = std::floor(steps);
  if (!(whole > -kLimit && whole < kLimit)) return {INT64_MIN / 2, 0};
  return {static_cast<std::int64_t>(whole) - first, steps - whole};
}

/// True where one of the two centres around a point is in the grid and has a non-zero weight.
bool reaches(const CentrePair& pair, std::int64_t size) {
  return (pair.before >= 0 && pair.before < size) || (pair.before == -1 && pair.fraction > 0);
}

}  // namespace

BilinearAccumulator::BilinearAccumulator(const GridSpec& spec)
    : Accumulator(spec), bins_(this->spec().size()), south_(spec), north_(spec) {}

void BilinearAccumulator::add(const GridPoints& points) {
  for (std::size_t begin = 0; begin < points.size(); begin += kPointsPerPass)
    add_pass(points.subset(begin, std::min(kPointsPerPass, points.size() - begin)));
}

void BilinearAccumulator::add_pass(const GridPoints& points) {
  constexpr std::size_t kPointsPerCount = std::size_t{1} << 16U;
  const GridSpec& grid = spec();
  std::vector<std::size_t> outside(points.size() / kPointsPerCount + 1);
  parallel_for(points.size(), kPointsPerCount, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const CentrePair x = centres_around(points.x_est[i], grid.resolution_m, grid.first_col);
      const CentrePair y = centres_around(points.y_est[i], grid.resolution_m, grid.first_row);
      if (!reaches(x, grid.cols) || !reaches(y, grid.rows)) ++outside[begin / kPointsPerCount];
    }
  });
  const auto rows = [&](bool north) {
    return [&points, &grid, north](std::size_t begin, std::size_t end, std::int32_t* row) {
      for (std::size_t i = begin; i < end; ++i) {
        const CentrePair y = centres_around(points.y_est[i], grid.resolution_m, grid.first_row);
        const std::int64_t found = y.before + (north ? 1 : 0);
        const bool counts = found >= 0 && found < grid.rows && (!north || y.fraction > 0);
        row[i - begin] = counts ? static_cast<std::int32_t>(found) : -1;
      }
    };
  };
  south_.assign(points.size(), rows(false));
  north_.assign(points.size(), rows(true));
  parallel_for(south_.band_count(), 1, [&](std::size_t band, std::size_t) { add_band(points, band); });
  std::size_t all_outside = 0;
  for (const std::size_t count : outside) all_outside += count;
  count_points(points.size(), all_outside);
}

/// The rows of a band see the returns below and above them in one order: that of the points.
void BilinearAccumulator::add_band(const GridPoints& points, std::size_t band) {
  const std::span<const std::uint32_t> south = south_.points_of_band(band);
  const std::span<const std::uint32_t> north = north_.points_of_band(band);
  auto s = south.begin();
  auto n = north.begin();
  while (s != south.end() || n != north.end()) {
    const bool take_south = n == north.end() || (s != south.end() && *s <= *n);
    add_to_row(points, take_south ? *s++ : *n++, !take_south);
  }
}

void BilinearAccumulator::add_to_row(const GridPoints& points, std::size_t i, bool north) {
  const GridSpec& grid = spec();
  const CentrePair x = centres_around(points.x_est[i], grid.resolution_m, grid.first_col);
  const CentrePair y = centres_around(points.y_est[i], grid.resolution_m, grid.first_row);
  const std::int64_t row = y.before + (north ? 1 : 0);
  const double row_weight = north ? y.fraction : 1 - y.fraction;
  const auto add_to = [&](std::int64_t col, double weight) {
    if (col >= 0 && col < grid.cols && weight > 0)
      add_return(points, i, weight * row_weight, bins_[grid.index({row, col})]);
  };
  add_to(x.before, 1 - x.fraction);
  add_to(x.before + 1, x.fraction);
}

void BilinearAccumulator::values(BinIndex first, std::span<BinValues> out) const {
  const std::span<const BinSums> sums = bins_.values().subspan(spec().index(first), out.size());
  std::ranges::transform(sums, out.begin(), values_of);
}

}  // namespace landfall
