// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/tool.h"
#include "evaluation/evaluate.h"
#include "exports/terrain_output.h"
#include "files/scan_file.h"
#include "scene/dem_output.h"
#include "simulation/simulation.h"

namespace landfall::cli {

// What each tool says of its result: the counts of --json, the conclusion, and warnings.

/// Also passes on the terrain's warnings.
void report_terrain(Session& session, const TerrainContent& terrain);

/// Warns where more than 1 % of the rays missed the terrain.
void report_scan(Session& session, const Simulation& simulation, const ScanWriter& writer);

/// Also passes on the warnings about the sigmas.
void report_dem(Session& session, const BinnedReturns& returns, const GridSpec& grid);

/// Warns where the judged region reaches beyond the bins with an elevation by more than 1 % of its width:
/// nobody looked there. `dem` begins the messages; `scanned` is valid_box() of its elevations. Returns
/// requirement_missed, and always says why, if all requirements must pass and one does not.
[[nodiscard]] ExitCode report_evaluation(Session& session, const std::string& dem,
                                         const Evaluation& evaluation, const BinBox& scanned,
                                         bool require_pass);

}  // namespace landfall::cli
