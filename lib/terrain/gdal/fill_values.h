// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "terrain/gdal/raster_statement.h"
#include "terrain/relief/dem_raster.h"

namespace landfall {

/// Looks for fill values that no tag declares, in samples after scaling, holes NaN: numbers that producers
/// use for "no data" (-32768, -32767, -9999, -99999, 9999, 1e6, extremes of the types and the like, and
/// anything beyond 1e12) and that are isolated from the rest: farther from it than a tenth of its relief, or
/// at its end, more than a thousandth of its relief off and more than 1 % of the samples.
///
/// Throws FormatError naming value and count where one of them lies in `needed`, a box of pixels of
/// `samples`. Returns a sentence, without the file's name, where zeros fill a side or half of the border and
/// no other sample is within a tenth of the relief of 0.
[[nodiscard]] std::optional<std::string> check_fill_values(const DemSamples& samples, const PixelBox& needed,
                                                           const Scaling& elevation, bool is_integer,
                                                           const DemBase& dem);

}  // namespace landfall
