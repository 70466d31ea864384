// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D411
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/session.h"
#include "files/meeting.h"

namespace landfall::cli {

/// The wishes that the options of `landfall run` express beside the configuration.
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
  std::string requirement = {};  ///< --require-pass where that is asked for; changes the exit code only
};

/// terrain-gen, scan-sim, regrid, dem-eval and, unless its section is null, hazard-map, for a resolved
/// configuration of `landfall run`.
[[nodiscard]] std::vector<ChainStage> chain_stages(const nlohmann::json& config, const ChainRequest& request);

/// The stage as a shell takes it: words in single quotes where they need them.
[[nodiscard]] std::string shell_command(const ChainStage& stage);

/// The record of what `landfall run` has made in a folder: for each output its file_id, or the hash of its
/// bytes, so that a file of another origin is never taken for one (the outputs equal those of the single
/// tools, so that no file says who made it); the table that each stage printed; whether it met its
/// requirement. It lies in the hidden file .landfall-run.json of the folder.
class ChainRecord {
 public:
  /// Empty if there is none, or none that can be read.
  explicit ChainRecord(std::filesystem::path folder);

  /// Whether this output exists and is not what was recorded.
  [[nodiscard]] bool is_foreign(const std::filesystem::path& output) const;
  /// Whether it exists and is what was recorded.
  [[nodiscard]] bool is_own(const std::filesystem::path& output) const;
  /// The table that the stage printed; empty if nothing is recorded.
  [[nodiscard]] std::string table(const ChainStage& stage) const;
  /// Whether the stage was asked for its requirement and met it.
  [[nodiscard]] bool has_met(const ChainStage& stage) const;
  /// Records the outputs of a stage, and writes the file. `met`: empty where the requirement was not asked
  /// for.
  void add(const ChainStage& stage, const std::string& table, std::optional<bool> met);

 private:
  std::filesystem::path folder_;
  nlohmann::json outputs_ = nlohmann::json::object();
  nlohmann::json stages_ = nlohmann::json::object();
};

}  // namespace landfall::cli
