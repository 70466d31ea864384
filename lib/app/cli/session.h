// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/core/progress.h"
#include "store/files/landfall_file.h"

namespace landfall::cli {

/// The options that all tools share (docs/user/cli.md).
struct CommonOptions {
  std::vector<std::string> config_names;  ///< of -c: files, "-", preset:NAME
  std::vector<std::string> assignments;
  std::string output_path;
  std::string view_path;  ///< an image of the output; empty: none
  bool overwrite = false;
  std::size_t threads = 0;
  std::optional<std::uint64_t> seed;
  bool quiet = false;
  bool verbose = false;
  std::optional<bool> progress;
  bool json_summary = false;
  bool print_config = false;
  bool print_schema = false;
  bool check_only = false;
  bool record_environment = false;
  bool list_presets = false;
  std::string log_path;
  std::string
      section;  ///< of a chain's configuration, of which this run is a stage; empty in a run of its own
  bool print_man = false;
  bool print_completion = false;
  int compression = 1;

  /// Whether a tool prints its table: with --table, and on a terminal.
  [[nodiscard]] bool shows_table(bool is_asked) const;
};

struct Host;
struct Tool;
class ProgressBar;
class RunLog;

/// The resources of one run of a tool.
class Session {
 public:
  /// `host` is null in a program of landfall.
  Session(const Tool& tool, const CommonOptions& options, RunLog& log, const Host* host);

  [[nodiscard]] const std::string& tool() const { return tool_; }
  [[nodiscard]] const CommonOptions& options() const { return options_; }
  /// The resolved configuration, and its name for messages.
  [[nodiscard]] const nlohmann::json& config() const { return config_; }
  [[nodiscard]] const std::string& config_name() const { return config_name_; }
  /// Throws UsageError without -o, or if the output exists, is not possible, has the extension of a format
  /// that this tool does not write, or is one of the run's own inputs; the same for the image of --view. Call
  /// it before the work.
  [[nodiscard]] OutputOptions output(const std::vector<std::string>& inputs = {});
  /// Throws UsageError if the file that `option` names cannot be an output, is one of `inputs`, the
  /// configuration or a file that the configuration names, or is another output of the run.
  void claim_output(const std::string& option, const std::string& path,
                    const std::vector<std::string>& inputs = {});
  /// Claims the file that an option other than -o names; null if the option is not given.
  [[nodiscard]] std::unique_ptr<OutputPath> side_output(const std::string& option, const std::string& path,
                                                        const std::vector<std::string>& inputs);
  /// The provenance of this run; the caller adds its inputs.
  [[nodiscard]] Provenance provenance() const;

  /// Throws UsageError if --view is given without -o.
  void require_output_for_view() const;
  /// Draws the output for --view if requested; call it after the run.
  void view_output();

  /// Runs one phase of the work: shows its progress on a terminal and records its wall and CPU time for
  /// --json. Returns its wall time, seconds.
  double phase(const std::string& name, const std::function<void(const ProgressCallback&)>& work);
  /// Shows a text next to the progress of the running phase, if that is shown.
  void note(const std::string& text);
  /// phase() as a function, for modules that run the phases themselves.
  [[nodiscard]] PhaseRunner phases() {
    return [this](const auto& name, const auto& work) { phase(name, work); };
  }
  /// Runs `work`, which applies the configuration to a file. A UsageError from it then names both, a
  /// FormatError the file.
  void with_file_names(const std::string& file, const std::function<void()>& work) const;
  /// Adds a count to the --json summary.
  void count(const std::string& name, nlohmann::json value) { counts_[name] = std::move(value); }
  /// Wall time since the start, seconds.
  [[nodiscard]] double elapsed_s() const;
  /// Prints a line on stderr, only with --verbose.
  void log(const std::string& line) const;
  /// Prints "TOOL: warning: text" on stderr, not with --quiet: what the user should know of a run that
  /// succeeds.
  void warn(const std::string& text);
  /// Prints the result of the run in one line on stderr, if that is a terminal, with --verbose, or if it must
  /// be seen; not with --quiet.
  void conclude(const std::string& text, bool must_be_seen = false) const;

  /// Resolves the configuration of `tool`; throws UsageError.
  void resolve_config(const Tool& tool);
  [[nodiscard]] nlohmann::json summary() const;

 private:
  void say(const std::string& text, bool shown) const;
  void claim_view(const std::vector<std::string>& inputs);

  std::string tool_;
  std::string schema_;
  CommonOptions options_;
  RunLog& log_;
  const Host* host_;
  bool writes_hdf5_;
  std::string config_name_;
  nlohmann::json config_;
  nlohmann::json phases_ = nlohmann::json::object();
  nlohmann::json counts_ = nlohmann::json::object();
  nlohmann::json warnings_ = nlohmann::json::array();
  std::vector<std::pair<std::string, std::string>> outputs_;  ///< option and path of each claimed output
  double start_s_;
  ProgressBar* bar_ = nullptr;  ///< of the running phase, if it is shown
};

}  // namespace landfall::cli
