// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

namespace landfall::cli {

/// A command of `landfall`.
struct CommandEntry {
  const char* name;     ///< "info"
  const char* tool;     ///< the program that it starts, "landfall-info"; empty if there is none
  const char* summary;  ///< one line without a full stop
};

/// The text of `landfall help`.
[[nodiscard]] std::string umbrella_help(std::span<const CommandEntry> commands);

/// The man page of `landfall`.
[[nodiscard]] std::string umbrella_manual(std::span<const CommandEntry> commands);

/// The bash completion of `landfall`: the first word is a command, the others are completed as those of its
/// tool, whose completion bash-completion loads on demand. Commands without a program complete file names,
/// but a command of which `own` contains the function of completion_function() uses that.
[[nodiscard]] std::string umbrella_completion(std::span<const CommandEntry> commands,
                                              const std::string& own = "");

}  // namespace landfall::cli
