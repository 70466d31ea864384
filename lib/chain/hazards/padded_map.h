// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/memory/large_memory.h"
#include "base/raster/grid.h"

namespace landfall {

/// A map with a margin of NaN around it, so that stencils and SIMD lanes may reach over its border.
class PaddedMap {
 public:
  /// Groups of places have at most as many; twice as many bins may be read beyond the margin.
  static constexpr std::int64_t kLanes = 16;

  /// NaN everywhere; margin >= 0 bins on each side.
  PaddedMap(const GridSpec& spec, std::int64_t margin)
      : rows_(spec.rows),
        cols_(spec.cols),
        margin_(margin),
        pitch_(spec.cols + 2 * margin + 2 * kLanes),
        values_(static_cast<std::size_t>((spec.rows + 2 * margin) * pitch_),
                std::numeric_limits<double>::quiet_NaN()) {}
  PaddedMap(const Grid<double>& map, std::int64_t margin);

  [[nodiscard]] std::int64_t rows() const { return rows_; }
  [[nodiscard]] std::int64_t cols() const { return cols_; }
  [[nodiscard]] std::int64_t margin() const { return margin_; }
  /// The bin's value; row and column may lie up to margin() bins outside.
  [[nodiscard]] const double* at(std::int64_t row, std::int64_t col) const {
    return values_.data() + (row + margin_) * pitch_ + col + margin_;
  }
  [[nodiscard]] double* at(std::int64_t row, std::int64_t col) {
    return values_.data() + (row + margin_) * pitch_ + col + margin_;
  }

 private:
  std::int64_t rows_, cols_, margin_, pitch_;
  std::vector<double, LargeAllocator<double>> values_;
};

}  // namespace landfall
