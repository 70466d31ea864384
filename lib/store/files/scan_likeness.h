// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "store/files/comparison.h"

namespace landfall {

/// Adds to the comparison of two scans how like they are (chain/likeness/likeness.h), B in the frame of A:
/// the places of both, `placement`, `likeness` (docs/reference/info-json.md) and `answer`, or `not_compared`,
/// why there is none. `request.on_layer` receives returns per bin and mean elevations as layers of a DEM.
///
/// Scans of more than 2^20 returns are compared in a square about the middle of what both cover, which has at
/// most so many of each. Throws FormatError as ScanReader does.
void add_likeness(nlohmann::ordered_json& comparison, const std::filesystem::path& a,
                  const std::filesystem::path& b, const ComparisonRequest& request,
                  const ProgressCallback& progress);

}  // namespace landfall
