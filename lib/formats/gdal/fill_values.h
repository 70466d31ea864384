// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "chain/terrain/relief/dem_raster.h"
#include "formats/gdal/raster_statement.h"

namespace landfall {

/// Searches samples after scaling, holes NaN, for fill values that no tag declares
/// (base/raster/fill_search.h).
///
/// Throws FormatError naming values and count where some of them lie in `needed`, a box of pixels of
/// `samples`. Returns a sentence, without the file's name, where zeros fill a side or half of the border and
/// no other sample is within a tenth of the relief of 0.
[[nodiscard]] std::optional<std::string> check_fill_values(const DemSamples& samples, const PixelBox& needed,
                                                           const Scaling& elevation, bool is_integer,
                                                           const DemBase& dem);

}  // namespace landfall
