// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/cli/tool.h"
#include "app/runs/draws_run.h"

namespace landfall::cli {

/// The options of monte-carlo; empty where they are not given.
struct DrawsOptions {
  std::vector<std::string> inputs;  ///< a scan or none, or merge and parts
  std::vector<std::string> pairs;
  std::string terrain, samples, draws, verdict, report, title;
  std::string engine = "cpu";
  bool table = false;
  bool require_pass = false;
  MeetingRules rules;

  [[nodiscard]] bool merges() const { return !inputs.empty() && inputs.front() == "merge"; }
  /// Whether each draw traces its own rays.
  [[nodiscard]] bool traces() const { return inputs.empty() && pairs.empty(); }
  /// The sources of a run that does not merge. Throws UsageError.
  [[nodiscard]] DrawsSources sources() const;
  /// The rows of --draws. Throws UsageError.
  [[nodiscard]] std::optional<DrawSpan> part() const;
};

void bind_draws_options(CLI::App& app, DrawsOptions& o);

/// Throws UsageError for options that do not go together.
void check_draws_options(const CommonOptions& common, const DrawsOptions& o);

}  // namespace landfall::cli
