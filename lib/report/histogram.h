// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/fields.h"
#include "raster/region.h"

namespace landfall::html_report {

/// The number of a region's values in each of equally wide classes from `low` to `high`, the least and the
/// greatest value. Empty if there is no value.
struct Histogram {
  double low = 0;
  double high = 0;
  std::vector<std::int64_t> count;
  LANDFALL_FIELDS(low, high, count)
};

/// NaN and infinite values are ignored. There is one class if all values are equal. T: double or float. The
/// result does not depend on the number of threads.
template <class T>
[[nodiscard]] Histogram histogram(const Grid<T>& layer, const BinMask& region, std::size_t classes);

}  // namespace landfall::html_report
