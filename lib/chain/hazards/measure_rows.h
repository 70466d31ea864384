// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

#include "chain/hazards/measures.h"

namespace landfall {

/// Rows that one task measures.
inline constexpr std::size_t kRowsPerPiece = 8;

/// Writes the measures of the places in rows begin .. end - 1; the other values stay NaN.
using MeasureRows = std::function<void(std::int64_t begin, std::int64_t end, PlaceMeasures& result)>;

/// Measures a map on all threads.
[[nodiscard]] PlaceMeasures measure_rows(const GridSpec& spec, const MeasureRows& rows,
                                         const ProgressCallback& progress);

}  // namespace landfall
