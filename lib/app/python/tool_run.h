// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace landfall {
namespace cli {
struct Invocation;
}

/// A tool as a function of its command line, as tools/tools.h declares it.
using ToolProgram = std::function<int(int argc, const char* const* argv, cli::Invocation* invocation)>;

/// A run of a tool within another program.
struct ToolResult {
  int code = 0;                         ///< the exit code
  std::string message{};                ///< of an error, without the tool's name
  std::vector<std::string> warnings{};  ///< in their order
  std::string printed{};                ///< what a program would write to standard output
  bool interrupted = false;             ///< ended by the caller: nothing of the above counts
};

/// Called by the waiting thread every 20 ms: the phase that is running, and its fraction done. True ends the
/// run at its next step, within about 0.1 s.
using WaitingFunction = std::function<bool(const std::string& phase, double fraction)>;

/// The command line of a run, from the name of the tool on, and the text of its standard input.
struct ToolCommand {
  std::vector<std::string> words;
  std::string standard_input{};
};

/// Runs a tool on a thread of its own, while this one waits; on this one if `waiting` is empty. Runs of
/// several threads go side by side; each file has one writer, and no reader before that has ended. Exceptions
/// of `waiting` end the run and are passed on.
[[nodiscard]] ToolResult run_tool(const ToolProgram& tool, const ToolCommand& command,
                                  const WaitingFunction& waiting);

}  // namespace landfall
