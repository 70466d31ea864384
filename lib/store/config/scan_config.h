// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/text/number_table.h"
#include "chain/lidar/simulation/simulation.h"

namespace landfall {

/// With the defaults that the schema cannot express: the pixel pitch, if neither ifov_rad nor fov_deg is
/// given, and the period of a spiral.
[[nodiscard]] nlohmann::json completed_scan_config(nlohmann::json resolved);

/// Builds the scan that a configuration describes (docs/user/scan-sim.md); `resolved` comes from
/// resolve_config(). `load_table` reads the tables that it names. If it is empty, the configuration is only
/// checked: no file is opened and random errors are not drawn. Throws UsageError that begins with `name` for
/// values that are out of range or incompatible, FormatError for an invalid table.
[[nodiscard]] ScanModel scan_model(const nlohmann::json& resolved, const std::string& name,
                                   const TableLoader& load_table);

}  // namespace landfall
