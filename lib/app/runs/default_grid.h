// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/runs/dem_output.h"
#include "base/raster/grid_spec.h"

namespace landfall {

/// Completes a configuration of regrid, before its defaults, for imported scans: half_width_m is their extent
/// about center_m, resolution_m the finest posting (1, 2, 5 x 10^k m, by which a given half width can be
/// divided) that leaves at most 5 % of the bins in the convex hull of their returns empty. Unchanged, without
/// reading points, where both are given, or where a scan is not an imported one or cannot be opened, of which
/// the run itself says why.
///
/// Returns a sentence about the choice. Throws UsageError where the returns have no extent and where no
/// posting divides the given half width; FormatError as the reader of scans does.
[[nodiscard]] std::optional<std::string> complete_grid(nlohmann::json& config, const DemSources& sources,
                                                       const std::string& config_name);

/// A sentence with a better posting, where more than half of a grid's bins in the convex hull of the imported
/// returns on it are empty.
[[nodiscard]] std::optional<std::string> posting_advice(const GridSpec& grid, const DemSources& sources);

}  // namespace landfall
