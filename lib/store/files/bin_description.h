// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/core/progress.h"
#include "chain/terrain/site_point.h"

namespace landfall {

/// The bin of a dem.h5 that holds a point: its centre, in the frame of the site and on the map of a site that
/// has a CRS, and the value of each layer, null where it has none.
/// With the scan that it was made from, also each return in the bin: pulse, pixel, time since the first
/// pulse, status, ranges, weight, z_est, and the share of its weight in the bin's sum (null for a method
/// without weights). Throws UsageError for a point off the map, FormatError for a scan that the DEM was not
/// made from.
[[nodiscard]] nlohmann::ordered_json describe_bin(const std::filesystem::path& dem, const SitePoint& point,
                                                  const std::optional<std::filesystem::path>& scan,
                                                  const ProgressCallback& progress = {});

}  // namespace landfall
