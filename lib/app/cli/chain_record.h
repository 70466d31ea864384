// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/chain.h"

namespace landfall::cli {

/// The chain of a folder: its name and its content.
///
/// Two chains with equal names are one, of which the later is an edition. Two with other names and an equal
/// configuration are one too: its file was renamed, moved or copied. Others are two chains.
struct ChainIdentity {
  /// The -c in their order and --from: paths relative to the folder, so that both can be moved together,
  /// "preset:NAME", and "content HASH" of standard input or a pipe.
  std::vector<std::string> names;
  /// The sections with all defaults, and "uncertainty"; paths of files are relative to the folder.
  nlohmann::json config;
};

/// The names that the command line of `landfall run` gives a chain.
struct ChainNames {
  std::vector<std::string> config_names;         ///< of -c
  std::string from;                              ///< of --from; empty without
  std::map<std::string, std::string> streams{};  ///< JsonSource::streams
};

/// The identity of a chain in an existing folder; `config` is a resolved configuration of `landfall run`.
[[nodiscard]] ChainIdentity chain_identity(const ChainNames& names, const nlohmann::json& config,
                                           const std::filesystem::path& folder);

/// The names as a message shows them: paths as seen from the current folder.
[[nodiscard]] std::string shown_names(const ChainIdentity& chain, const std::filesystem::path& folder);

/// The differences of two JSON objects in words, the keys of both first: "noise.range_sigma_m 0.01 -> 0.02,
/// and 3 more keys". Empty if there are none.
[[nodiscard]] std::string differences_text(const nlohmann::json& before, const nlohmann::json& after);

/// The step that made a landfall file, as Provenance::as_step(); null if it is not a complete one.
[[nodiscard]] nlohmann::json step_of(const std::filesystem::path& output);

/// The reason why a step gives another file than before: the differences in its configuration, options,
/// inputs and version. Empty if the file_id is the same.
[[nodiscard]] std::string replacement_reason(const nlohmann::json& before, const nlohmann::json& after);

/// The record of the outputs of `landfall run` in a folder: the chain; for each output its file_id, or the
/// hash of its bytes, also of one that is about to get its name, so that a file of another origin is never
/// taken for one (the outputs equal those of the single tools, so that no file says who made it); the table
/// that each stage printed; whether it met its requirement. It lies in the hidden file .landfall-run.json of
/// the folder.
class ChainRecord {
 public:
  /// Empty if there is none, or none that can be read.
  explicit ChainRecord(std::filesystem::path folder);

  /// Whether this output exists and is neither what was recorded nor what was about to get its name when a
  /// run ended.
  [[nodiscard]] bool is_foreign(const std::filesystem::path& output) const;
  /// Whether it exists and is what was recorded.
  [[nodiscard]] bool is_own(const std::filesystem::path& output) const;
  /// Whether it exists and got its name from a stage that was not recorded.
  [[nodiscard]] bool is_announced(const std::filesystem::path& output) const;
  /// The table that the stage printed; empty if nothing is recorded.
  [[nodiscard]] std::string table(const ChainStage& stage) const;
  /// Whether the stage had a requirement and met it.
  [[nodiscard]] bool has_met(const ChainStage& stage) const;
  /// The names of the recorded outputs that still exist.
  [[nodiscard]] std::vector<std::string> outputs() const;
  /// The chain of these outputs; empty for a record of version 0.2.0, which has none.
  [[nodiscard]] const std::optional<ChainIdentity>& chain() const { return chain_; }
  /// The chain of all later outputs. The next call of add() or save() writes it.
  void set_chain(ChainIdentity chain);
  /// Notes that the temporary files of a stage are about to get their names, and writes the file.
  void announce(const ChainStage& stage);
  /// Records the outputs of a stage, and writes the file. `met`: empty where the requirement was not asked
  /// for.
  void add(const ChainStage& stage, const std::string& table, std::optional<bool> met);
  /// Writes the file if it lacks the chain of set_chain().
  void save();

 private:
  void write();

  std::filesystem::path folder_;
  nlohmann::json outputs_ = nlohmann::json::object();
  nlohmann::json announced_ = nlohmann::json::object();
  nlohmann::json stages_ = nlohmann::json::object();
  std::optional<ChainIdentity> chain_;
  bool is_saved_ = true;
};

}  // namespace landfall::cli
