// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "evaluation/coverage.h"
#include "files/landfall_file.h"
#include "simulation/scan_plan.h"

namespace landfall {

/// What a plan tells of its region.
struct PlanSummary {
  /// {"region", "time", "returns", "coverage", "returns_per_bin", "images_per_bin"}: docs/scan-sim.md says
  /// what each is.
  nlohmann::ordered_json numbers;
  Grid<std::int32_t> hole_id;  ///< of the bins without a return (Coverage)
};

/// `radius_m` is that of the plan's region.
[[nodiscard]] PlanSummary summarize_plan(const ScanPlan& plan, double radius_m, double pulse_rate_hz);

/// Writes the layers count, images, first_seen, in_region and hole_id, and the numbers as /plan_json;
/// commits.
void write_plan(LandfallFileWriter& file, const ScanPlan& plan, const PlanSummary& summary);

}  // namespace landfall
