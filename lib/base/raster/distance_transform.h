// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/raster/region.h"

namespace landfall {

/// The squared distance where the DEM has no valid bin.
inline constexpr std::int64_t kNoValidBin = INT64_MAX;

/// The squared Euclidean distance, in bins, from each bin to the nearest bin whose mask is set: exact
/// integers, 0 on set bins, kNoValidBin everywhere if no bin is set. Linear time (Meijster, Roerdink and
/// Hesselink 2000), parallel by columns, then by rows.
[[nodiscard]] Grid<std::int64_t> squared_distance(const BinMask& set);

/// The distance in bins; infinite for kNoValidBin.
[[nodiscard]] double bins_apart(std::int64_t squared);

}  // namespace landfall
