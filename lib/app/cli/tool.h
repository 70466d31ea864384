// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "app/cli/session.h"
#include "base/core/error.h"
#include "store/config/json_source.h"

namespace CLI {
class App;
}

namespace landfall::cli {

/// The declaration of a tool in its source file.
struct Tool {
  explicit Tool(std::string known_name);  ///< with what schemas/dictionary/tools.json says of it

  std::string name;
  std::string summary;           ///< one line
  std::string description = {};  ///< for the man page: paragraphs, separated by empty lines
  /// Shown under --help: "Examples:", commands indented by two spaces, then lines of prose.
  std::string examples;
  std::string schema;  ///< name for embedded_schema(); empty for a tool without a configuration
  std::string exit_3;  ///< when it ends with 3; empty if never
  std::string plugin;  ///< the plugin for rasters that it may need; empty if none
  bool has_seed = false;
  std::string seed_key = "/seed";       ///< what --seed sets, a JSON pointer
  bool writes_hdf5 = true;              ///< false: the tool checks the extension of its output itself
  bool writes = true;                   ///< false: no -o, no summary of the run
  bool writes_side_file = false;        ///< without -o: an option of its own writes a file, so that it has -O
  bool writes_folder = false;           ///< -o names a folder; no --view
  std::function<void(CLI::App&)> bind;  ///< declares the tool's own options; opens nothing
  /// Translates the tool's own options into configuration values, before --set; may be empty.
  std::function<void(JsonSource&, const CommonOptions&)> expand;
  /// Changes values after --set: fills in the values that the inputs determine, or applies options that
  /// override the configuration; may be empty.
  std::function<void(JsonSource&)> complete;
  /// Builds the typed configuration, so that --check also finds errors that the schema cannot express; not
  /// called without a schema.
  std::function<void(Session&)> check;
  std::function<ExitCode(Session&)> run;
};

/// Thrown by Host::progress to end a run; no std::exception, so that nothing takes it for a failure.
struct Interrupted {};

/// A program that runs tools as functions of its own process, such as Python: nothing is printed, no signal
/// is taken, and no state of the process is left changed.
struct Host {
  std::function<void(const std::string& text)> warn;  ///< gets Session::warn()'s texts
  std::function<void(const std::string& text)>
      fail;  ///< gets the message of an error, without the tool's name
  /// Called with the progress of each phase, from any thread, one call at a time; may throw Interrupted.
  std::function<void(const std::string& phase, double fraction)> progress;
};

/// A run that another program of landfall starts.
struct Invocation {
  bool keep_same = false;  ///< leaves an output that this run would not change
  bool kept = false;       ///< it was left
  std::string
      section{};  ///< of the configuration that --set has, for messages: "chain.json: /eval"; or empty
  const Host* host = nullptr;  ///< null in a program of landfall
};

/// Parses the command line, prints requested texts, runs the tool; contains the only catch. Exit codes as in
/// docs/user/cli.md; every error is one line on stderr that begins with the tool's name. `invocation` may be
/// null.
int tool_main(int argc, const char* const* argv, const Tool& tool, Invocation* invocation = nullptr);

}  // namespace landfall::cli
