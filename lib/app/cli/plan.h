// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "app/cli/tool.h"
#include "store/files/plan_file.h"

namespace landfall::cli {

/// The options of scan-sim --plan.
struct PlanOptions {
  bool requested = false;
  double radius_m = 50;
  double resolution_m = 0.05;
  double filled_frac = 0.99;  ///< of the bins of the proposed posting
};

void bind_plan(CLI::App& app, PlanOptions& options);

/// Computes the time budget and the coverage of flat terrain of the session's scan, prints them, and writes
/// plan.h5 if there is an output. Throws UsageError for a radius or resolution that is not positive.
ExitCode run_plan(Session& session, const PlanOptions& options, std::int64_t batch_points);

/// A plan as lines of text: use of time and coverage.
[[nodiscard]] std::string plan_table(const PlanMetrics& plan);

}  // namespace landfall::cli
