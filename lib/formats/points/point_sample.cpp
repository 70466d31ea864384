// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/point_sample.h"

#include <algorithm>

namespace landfall {
namespace {

/// A number of 31 bits that changes irregularly with i.
std::uint64_t scattered(std::uint64_t i) { return (i * 0x9E3779B97F4A7C15U) >> 33U; }

}  // namespace

void PointSample::add(const CloudBatch& batch) {
  const std::uint64_t end = begin_ + batch.size();
  while (next_ < end) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      positions_[axis].push_back(batch.columns[axis][next_ - begin_]);
    ++block_;
    if (size() == kMax) thin();
    plan_next();
  }
  begin_ = end;
}

std::pair<double, double> PointSample::middle_range(std::size_t axis) const {
  std::vector<double> sorted = positions_[axis];
  std::ranges::sort(sorted);
  const std::size_t tail = sorted.size() / 100;
  return {sorted[tail], sorted[sorted.size() - 1 - tail]};
}

void PointSample::plan_next() { next_ = block_ * stride_ + scattered(block_) % stride_; }

/// Keeps one of each two points.
void PointSample::thin() {
  for (std::vector<double>& column : positions_) {
    for (std::size_t i = 0; i < kMax / 2; ++i) column[i] = column[2 * i + scattered(i) % 2];
    column.resize(kMax / 2);
  }
  stride_ *= 2;
  block_ /= 2;
}

}  // namespace landfall
