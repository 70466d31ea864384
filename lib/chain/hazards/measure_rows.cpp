// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/measure_rows.h"

#include "base/core/parallel.h"
#include "base/numerics/non_finite.h"

namespace landfall {

PlaceMeasures measure_rows(const GridSpec& spec, const MeasureRows& rows, const ProgressCallback& progress) {
  PlaceMeasures result{Grid<double>(spec, kNan), Grid<double>(spec, kNan)};
  parallel_for(
      static_cast<std::size_t>(spec.rows), kRowsPerPiece,
      [&](std::size_t begin, std::size_t end) {
        rows(static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end), result);
      },
      progress);
  return result;
}

}  // namespace landfall
