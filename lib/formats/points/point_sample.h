// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "formats/points/cloud_reader.h"

namespace landfall {

/// A sample of the positions of a file, in bounded memory: one point of each block of equal length, at a
/// place that differs from block to block, so that rows of a raster do not repeat in it. All points of a
/// small file.
class PointSample {
 public:
  static constexpr std::size_t kMax = 1U << 15U;

  /// Adds consecutive points.
  void add(const CloudBatch& batch);

  [[nodiscard]] std::size_t size() const { return positions_[0].size(); }
  /// The number of points that it stands for.
  [[nodiscard]] std::int64_t point_count() const { return static_cast<std::int64_t>(begin_); }
  /// The coordinates between which 98 % of the sample lie, which must not be empty.
  [[nodiscard]] std::pair<double, double> middle_range(std::size_t axis) const;
  [[nodiscard]] const std::vector<double>& operator[](std::size_t axis) const { return positions_[axis]; }

 private:
  void plan_next();
  void thin();

  std::array<std::vector<double>, 3> positions_;
  std::uint64_t begin_ = 0;  ///< number of points before the next batch
  std::uint64_t stride_ = 1;
  std::uint64_t block_ = 0;
  std::uint64_t next_ = 0;  ///< the point to take
};

}  // namespace landfall
