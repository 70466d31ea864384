// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/core/progress.h"
#include "chain/terrain/site_point.h"

namespace landfall {

/// The files that tell more of a footprint.
struct FootprintSources {
  std::optional<std::filesystem::path> dem;   ///< returns, noise and slope of the bins
  std::optional<std::filesystem::path> scan;  ///< noise of the ranges, motion of the lidar
};

/// The footprint of an eval.h5 that is centred on the bin that holds a point: its errors next to their
/// limits, its five worst bins, and the likely cause if it misses a requirement (failure_cause.h; keys:
/// docs/reference/info-json.md). Throws UsageError for a point off the map, FormatError for an evaluation
/// without layers, and for a DEM or a scan that it was not made from.
[[nodiscard]] nlohmann::ordered_json describe_footprint(const std::filesystem::path& evaluation,
                                                        const SitePoint& point,
                                                        const FootprintSources& sources,
                                                        const ProgressCallback& progress = {});

}  // namespace landfall
