// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D22, D60
#include "base/raster/footprint.h"

namespace landfall {

Footprint Footprint::square(std::int64_t half_bins) {
  return {true, std::vector<std::int64_t>(static_cast<std::size_t>(half_bins + 1), half_bins)};
}

Footprint Footprint::disc(std::int64_t squared_radius) {
  std::int64_t half = 0;
  while ((half + 1) * (half + 1) <= squared_radius) ++half;
  std::vector<std::int64_t> half_widths;
  for (std::int64_t width = half, offset = 0; offset <= half; ++offset) {
    while (width * width + offset * offset > squared_radius) --width;
    half_widths.push_back(width);
  }
  return {false, std::move(half_widths)};
}

std::int64_t Footprint::bin_count() const {
  std::int64_t count = 0;
  for (std::int64_t row = -half_bins(); row <= half_bins(); ++row) count += 2 * half_width(row) + 1;
  return count;
}

std::int64_t Footprint::squared_offsets() const {
  std::int64_t sum = 0;
  for (std::int64_t row = -half_bins(); row <= half_bins(); ++row)
    sum += row * row * (2 * half_width(row) + 1);
  return sum;
}

}  // namespace landfall
