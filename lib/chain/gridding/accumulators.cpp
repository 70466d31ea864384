// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D50, D51, D52
#include "chain/gridding/accumulators.h"

#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "base/core/error.h"
#include "base/core/parallel.h"

namespace landfall {
namespace {

/// The values of a bin of `count` (> 0) returns without weights, one of which was chosen.
BinValues chosen_values(const ChosenReturn& chosen, std::int32_t count, double spread) {
  return {.count = count,
          .weight_sum = static_cast<double>(count),
          .z_est = chosen.z,
          .x_true = chosen.x_true,
          .y_true = chosen.y_true,
          .x_est = chosen.x_est,
          .y_est = chosen.y_est,
          .x_offset = chosen.x_true - chosen.x_est,
          .y_offset = chosen.y_true - chosen.y_est,
          .t = chosen.t,
          .spread = spread};
}

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

ExtremeAccumulator::ExtremeAccumulator(const GridSpec& spec, Which which)
    : Accumulator(spec), which_(which), bins_(this->spec().size()), nearest_(spec) {}

void ExtremeAccumulator::add(const GridPoints& points) {
  const std::span<Bin> bins = bins_.values();
  const std::size_t outside =
      nearest_.for_each(points, [&](const GridSpec&, const GridPoints& piece, std::size_t i,
                                    std::size_t bin) { add_point(piece, i, bins[bin]); });
  count_points(points.size(), outside);
}

void ExtremeAccumulator::add_point(const GridPoints& points, std::size_t i, Bin& bin) const {
  const double z = points.z_est[i];
  if (bin.count == 0) bin.z_first = z;
  if (bin.count == 0 || (which_ == Which::lowest ? z < bin.chosen.z : z > bin.chosen.z))
    bin.chosen = {.z = z,
                  .x_true = points.x_true[i],
                  .y_true = points.y_true[i],
                  .x_est = points.x_est[i],
                  .y_est = points.y_est[i],
                  .t = points.t[i]};
  const double dz = z - bin.z_first;
  bin.dz += dz;
  bin.dz_dz += dz * dz;
  ++bin.count;
}

BinValues ExtremeAccumulator::values_of(const Bin& bin) {
  if (bin.count == 0) return empty_bin();
  const auto n = static_cast<double>(bin.count);
  const double mean_dz = bin.dz / n;
  return chosen_values(bin.chosen, bin.count, std::sqrt(std::max(0.0, bin.dz_dz / n - mean_dz * mean_dz)));
}

void ExtremeAccumulator::values(BinIndex first, std::span<BinValues> out) const {
  const std::span<const Bin> bins = bins_.values().subspan(spec().index(first), out.size());
  std::ranges::transform(bins, out.begin(), values_of);
}

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

// The memory of the median is limited by reading the scans several times, not by estimating the
// median: the result is exact.
MedianAccumulator::MedianAccumulator(const GridSpec& spec, std::int64_t points_at_a_time)
    : Accumulator(spec),
      points_at_a_time_(points_at_a_time),
      bins_(this->spec().size()),
      row_counts_(static_cast<std::size_t>(spec.rows)) {}

void MedianAccumulator::add(const GridPoints& points) {
  if (pass_ == 0) {
    count_row(points);
  } else {
    gather(points);
  }
}

void MedianAccumulator::count_row(const GridPoints& points) {
  std::size_t outside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const BinIndex bin = spec().bin_of(points.x_est[i], points.y_est[i]);
    if (spec().contains(bin)) {
      ++row_counts_[static_cast<std::size_t>(bin.row)];
    } else {
      ++outside;
    }
  }
  count_points(points.size(), outside);
}

void MedianAccumulator::gather(const GridPoints& points) {
  const std::int64_t begin = band_rows_[pass_ - 1];
  const std::int64_t end = band_rows_[pass_];
  for (std::size_t i = 0; i < points.size(); ++i) {
    const BinIndex bin = spec().bin_of(points.x_est[i], points.y_est[i]);
    if (bin.row < begin || bin.row >= end || !spec().contains(bin)) continue;
    gathered_.push_back({points.z_est[i], points.x_true[i], points.y_true[i], points.x_est[i],
                         points.y_est[i], points.t[i], spec().index(bin), gathered_.size()});
  }
}

bool MedianAccumulator::end_pass() {
  if (pass_ == 0) {
    plan();
  } else {
    find_medians();
  }
  ++pass_;
  const bool more = pass_ < band_rows_.size();
  if (!more) gathered_ = {};
  return more;
}

/// Divides the rows into bands with at most as many returns as are gathered at a time.
void MedianAccumulator::plan() {
  std::int64_t in_band = 0;
  std::int64_t maximum = 0;
  band_rows_ = {0};
  for (std::int64_t row = 0; row < spec().rows; ++row) {
    const std::int64_t count = row_counts_[static_cast<std::size_t>(row)];
    if (count > points_at_a_time_)
      throw FormatError("method median: the row of bins at y = " + std::to_string(spec().y(row)) +
                        " m holds " + std::to_string(count) + " returns; at most " +
                        std::to_string(points_at_a_time_) + " can be sorted at a time");
    if (in_band + count > points_at_a_time_) {
      band_rows_.push_back(row);
      in_band = 0;
    }
    in_band += count;
    maximum = std::max(maximum, in_band);
  }
  band_rows_.push_back(spec().rows);
  gathered_.reserve(static_cast<std::size_t>(maximum));
}

void MedianAccumulator::find_medians() {
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_sort(gathered_.begin(), gathered_.end(), [](const Return& a, const Return& b) {
      return std::tie(a.bin, a.z, a.number) < std::tie(b.bin, b.z, b.number);
    });
  });
  for (auto begin = gathered_.begin(); begin != gathered_.end();) {
    const auto end =
        std::find_if(begin, gathered_.end(), [&](const Return& r) { return r.bin != begin->bin; });
    bins_[begin->bin] = median_of({begin, end});
    begin = end;
  }
  gathered_.clear();
}

MedianAccumulator::Bin MedianAccumulator::median_of(std::span<const Return> sorted) {
  const Return& a = sorted[(sorted.size() - 1) / 2];
  const Return& b = sorted[sorted.size() / 2];
  const double z_first = sorted.front().z;
  double sum = 0;
  double squares = 0;
  for (const Return& r : sorted) {
    sum += r.z - z_first;
    squares += (r.z - z_first) * (r.z - z_first);
  }
  const auto n = static_cast<double>(sorted.size());
  const double variance = std::max(0.0, squares / n - (sum / n) * (sum / n));
  const auto middle = [](double u, double v) { return (u + v) / 2; };
  return {{middle(a.z, b.z), middle(a.x_true, b.x_true), middle(a.y_true, b.y_true), middle(a.x_est, b.x_est),
           middle(a.y_est, b.y_est), middle(a.t, b.t)},
          static_cast<float>(std::sqrt(variance)),
          static_cast<std::int32_t>(sorted.size())};
}

double MedianAccumulator::progress(double pass_fraction) const {
  constexpr double kFirst = 0.1;
  if (pass_ == 0) return kFirst * pass_fraction;
  const auto passes = static_cast<double>(band_rows_.size() - 1);
  return kFirst + (1 - kFirst) * (static_cast<double>(pass_ - 1) + pass_fraction) / passes;
}

BinValues MedianAccumulator::values_of(const Bin& bin) {
  if (bin.count == 0) return empty_bin();
  return chosen_values(bin.chosen, bin.count, static_cast<double>(bin.spread));
}

void MedianAccumulator::values(BinIndex first, std::span<BinValues> out) const {
  const std::span<const Bin> bins = bins_.values().subspan(spec().index(first), out.size());
  std::ranges::transform(bins, out.begin(), values_of);
}

}  // namespace landfall
