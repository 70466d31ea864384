// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "app/cli/tool.h"
#include "app/exports/terrain_output.h"
#include "app/runs/dem_output.h"
#include "chain/evaluation/evaluate.h"
#include "chain/hazards/hazard_map.h"
#include "chain/lidar/simulation/simulation.h"
#include "chain/opencl/devices.h"
#include "store/files/scan_file.h"

namespace landfall::cli {

// The outcome of each tool: the counts of --json, the conclusion, and warnings.

/// Also passes on the terrain's warnings.
void report_terrain(Session& session, const TerrainContent& terrain);

/// Warns where more than 1 % of the rays missed the terrain.
void report_scan(Session& session, const Simulation& simulation, const ScanWriter& writer);

/// Adds the device and its draws to the counts. Warns if the CPU had to replace it.
void report_draw_device(Session& session, const DeviceUse& use);

/// Also passes on the warnings about the sigmas.
void report_dem(Session& session, const BinnedReturns& returns, const GridSpec& grid);

/// The distance that the nodes of a truth may have.
struct SpacingLimit {
  double spacing_m;
  const char* excess;  ///< "farther apart than a pad is wide"
  const char* object;  ///< "a pad": meets what lies between the nodes
};

/// Warns of a truth whose nodes are farther apart, unless it is that of an import.
void warn_of_spacing(Session& session, const std::string& dem, std::optional<double> spacing_m,
                     bool is_imported, const SpacingLimit& limit);

/// Warns where relative errors are not judged (why_not_judged()), and where the truth's nodes are farther
/// apart than a fifth of the footprint, unless the truth is that of an import.
void warn_of_assumptions(Session& session, const std::string& dem, const Metrics& metrics,
                         const EvaluationParameters& parameters, double resolution_m, bool is_imported);

/// Warns where the judged region reaches beyond the bins with an elevation by more than 1 % of its width:
/// nobody looked there. `dem` begins the messages; `scanned` is valid_box() of its elevations. Returns
/// requirement_missed, and always says why, if all requirements must pass and one does not.
[[nodiscard]] ExitCode report_evaluation(Session& session, const std::string& dem,
                                         const Evaluation& evaluation, const BinBox& scanned,
                                         bool require_pass);

/// Also passes on the numbers of places, sites and score. Warns if every place is unknown on the true
/// terrain. With `min_p`, a site of that p_touchdown and the user's own requirements are required: returns
/// requirement_missed, and always says why, without. `name` begins the messages.
[[nodiscard]] ExitCode report_hazards(Session& session, const std::string& name, const HazardMap& map,
                                      const RequirementVerdicts& own, std::optional<double> min_p);

}  // namespace landfall::cli
