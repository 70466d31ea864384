// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace landfall {

/// The lander's footprint about a centre bin: an odd number of rows, with a span of columns in each.
class Footprint {
 public:
  /// A square of 2 half_bins + 1 bins.
  [[nodiscard]] static Footprint square(std::int64_t half_bins);
  /// The bins at (i, j) from the centre with i^2 + j^2 <= squared_radius, computed in integers.
  [[nodiscard]] static Footprint disc(std::int64_t squared_radius);

  [[nodiscard]] bool is_square() const { return is_square_; }
  /// Rows above and below the centre row, which is also the largest half width.
  [[nodiscard]] std::int64_t half_bins() const { return static_cast<std::int64_t>(half_widths_.size()) - 1; }
  /// Rows of a square, and the diameter of a disc in bins.
  [[nodiscard]] std::int64_t edge_bins() const { return 2 * half_bins() + 1; }
  /// Columns on either side of the centre column in row `offset` above or below, |offset| <= half_bins().
  [[nodiscard]] std::int64_t half_width(std::int64_t offset) const {
    return half_widths_[static_cast<std::size_t>(offset < 0 ? -offset : offset)];
  }

  [[nodiscard]] std::int64_t bin_count() const;
  /// The sum of the squared row offsets of all bins; for columns it is the same.
  [[nodiscard]] std::int64_t squared_offsets() const;

 private:
  Footprint(bool is_square, std::vector<std::int64_t> half_widths)
      : is_square_(is_square), half_widths_(std::move(half_widths)) {}

  bool is_square_;
  std::vector<std::int64_t> half_widths_;  ///< by row offset; not increasing
};

}  // namespace landfall
