// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D411
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/cli/session.h"
#include "store/files/meeting.h"

namespace landfall::cli {

/// The wishes that the options of `landfall run` express in addition to the configuration.
struct ChainRequest {
  std::filesystem::path folder;
  bool require_pass = false;
  bool require_safe = false;
  MeetingRules rules = {};
};

/// One tool of a chain with its arguments.
struct ChainStage {
  std::string tool;
  std::vector<std::string> arguments;  ///< all that decide the content of the outputs, and the outputs
  std::filesystem::path output;        ///< HDF5
  std::vector<std::filesystem::path> side_outputs = {};
  std::string requirement = {};  ///< --require-pass if it is given; changes the exit code only
};

/// terrain-gen, scan-sim, regrid, dem-eval and, unless its section is null, hazard-map, for a resolved
/// configuration of `landfall run`.
[[nodiscard]] std::vector<ChainStage> chain_stages(const nlohmann::json& config, const ChainRequest& request);

/// The stage as a shell takes it: words in single quotes where they need them.
[[nodiscard]] std::string shell_command(const ChainStage& stage);

}  // namespace landfall::cli
