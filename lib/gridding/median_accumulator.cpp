// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D51
//
// Median in passes. Its memory is limited by reading the scans several times, not by estimating the
// median: the result is exact.
#include "gridding/median_accumulator.h"

#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "base/error.h"

namespace landfall {

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
  std::int64_t most = 0;
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
    most = std::max(most, in_band);
  }
  band_rows_.push_back(spec().rows);
  gathered_.reserve(static_cast<std::size_t>(most));
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
  return landfall::values_of(bin.chosen, bin.count, static_cast<double>(bin.spread));
}

void MedianAccumulator::values(BinIndex first, std::span<BinValues> out) const {
  const std::span<const Bin> bins = bins_.values().subspan(spec().index(first), out.size());
  std::ranges::transform(bins, out.begin(), values_of);
}

}  // namespace landfall
