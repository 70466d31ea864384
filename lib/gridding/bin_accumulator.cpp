// SPDX-License-Identifier: GPL-3.0-or-later
#include "gridding/bin_accumulator.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"

namespace landfall {
namespace {

static_assert(sizeof(BinSums) == 80);

// So many points at a time: the partition's own memory stays at 32 MB however large the batch.
constexpr std::size_t kPointsPerPass = std::size_t{1} << 22U;
constexpr std::size_t kPointsPerCheck = std::size_t{1} << 16U;

const GridSpec& checked(const GridSpec& spec) {
  if (!std::isfinite(spec.resolution_m) || spec.resolution_m <= 0)
    throw UsageError("grid: resolution_m " + std::to_string(spec.resolution_m) +
                     " is not finite and positive");
  if (spec.rows < 1 || spec.cols < 1)
    throw UsageError("grid: " + std::to_string(spec.rows) + " x " + std::to_string(spec.cols) +
                     " bins; at least 1 x 1 are needed");
  return spec;
}

struct Column {
  const char* name;
  std::span<const double> values;
};

std::array<Column, 7> columns(const GridPoints& p) {
  return {{{"x_est", p.x_est},
           {"y_est", p.y_est},
           {"z_est", p.z_est},
           {"x_true", p.x_true},
           {"y_true", p.y_true},
           {"z_true", p.z_true},
           {"t", p.t}}};
}

bool all_finite(std::span<const double> values) {
  bool finite = true;  // no early exit: the loop then runs as fast as memory
  for (const double v : values) finite &= std::abs(v) <= std::numeric_limits<double>::max();
  return finite;
}

void throw_first_bad_row(const GridPoints& points, std::int64_t first_row_number) {
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const Column& column : columns(points))
      if (!std::isfinite(column.values[i]))
        throw FormatError("row " + std::to_string(first_row_number + static_cast<std::int64_t>(i)) + ": " +
                          column.name + " is " + std::to_string(column.values[i]) +
                          "; the coordinates of a return must be finite");
}

void require_finite(const GridPoints& points, std::int64_t first_row_number) {
  const std::size_t pieces = (points.size() + kPointsPerCheck - 1) / kPointsPerCheck;
  std::vector<char> finite(pieces, 1);
  parallel_for(points.size(), kPointsPerCheck, [&](std::size_t begin, std::size_t end) {
    for (const Column& column : columns(points))
      if (!all_finite(column.values.subspan(begin, end - begin))) finite[begin / kPointsPerCheck] = 0;
  });
  if (std::ranges::find(finite, 0) != finite.end()) throw_first_bad_row(points, first_row_number);
}

}  // namespace

BinAccumulator::BinAccumulator(const GridSpec& spec)
    : spec_(checked(spec)), bins_(spec.size()), partition_(spec) {}

void BinAccumulator::add(const GridPoints& points, std::int64_t first_row_number) {
  for ([[maybe_unused]] const Column& column : columns(points)) assert(column.values.size() == points.size());
  for (std::size_t begin = 0; begin < points.size(); begin += kPointsPerPass) {
    const GridPoints piece = points.subset(begin, std::min(kPointsPerPass, points.size() - begin));
    require_finite(piece, first_row_number + static_cast<std::int64_t>(begin));
    add_piece(piece);
  }
}

void BinAccumulator::add_piece(const GridPoints& points) {
  partition_.assign(points.x_est, points.y_est);
  parallel_for(partition_.band_count(), 1, [&](std::size_t band, std::size_t) {
    for (const std::uint32_t i : partition_.points_of_band(band)) add_point(points, i);
  });
  const auto outside = static_cast<std::int64_t>(partition_.outside_count());
  outside_count_ += outside;
  inside_count_ += static_cast<std::int64_t>(points.size()) - outside;
}

void BinAccumulator::add_point(const GridPoints& points, std::size_t i) {
  const double x_est = points.x_est[i];
  const double y_est = points.y_est[i];
  const BinIndex index = spec_.bin_of(x_est, y_est);
  const double p = std::abs(x_est - spec_.x(index.col)) / spec_.resolution_m;
  const double q = std::abs(y_est - spec_.y(index.row)) / spec_.resolution_m;
  const double w = (1 - p) * (1 - q);
  BinSums& bin = bins_[spec_.index(index)];
  if (bin.count == 0) bin.z_first = points.z_est[i];
  const double dz = points.z_est[i] - bin.z_first;
  bin.weight += w;
  bin.w_dz += w * dz;
  bin.w_dz_dz += w * dz * dz;
  bin.w_x_true += w * points.x_true[i];
  bin.w_y_true += w * points.y_true[i];
  bin.w_x_est += w * x_est;
  bin.w_y_est += w * y_est;
  bin.w_t += w * points.t[i];
  ++bin.count;
}

}  // namespace landfall
