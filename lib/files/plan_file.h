// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "evaluation/coverage.h"
#include "files/landfall_file.h"
#include "simulation/scan_plan.h"

namespace landfall {

/// A plan in numbers: {"region", "time", "returns", "coverage", "returns_per_bin", "images_per_bin"}
/// (docs/user/scan-sim.md says what each is). `coverage` is that of the plan's bins.
[[nodiscard]] nlohmann::ordered_json plan_json(const ScanPlan& plan, const CoverageMetrics& coverage,
                                               double radius_m, double pulse_rate_hz);

/// Writes the layers count, images, first_seen, in_region and hole_id, and `numbers` as /plan_json; commits.
void write_plan(LandfallFileWriter& file, const ScanPlan& plan, const Grid<std::int32_t>& hole_id,
                const nlohmann::ordered_json& numbers);

}  // namespace landfall
