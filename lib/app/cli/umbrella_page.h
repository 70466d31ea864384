// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall::cli {

// The commands are those of schemas/dictionary/tools.json.

/// The text of `landfall help`, or, of the commands whose first word is `group`, that of `landfall GROUP`;
/// empty if there are none.
[[nodiscard]] std::string umbrella_help(const std::string& group = "");

/// The man page of `landfall`.
[[nodiscard]] std::string umbrella_manual();

/// The bash completion of `landfall`: the first word is a command, the others are completed as those of its
/// tool, whose completion bash-completion loads on demand. Commands of Python complete file names and the
/// options of their --help, and those of which `own` contains the function of completion_function() use that.
[[nodiscard]] std::string umbrella_completion(const std::string& own = "");

}  // namespace landfall::cli
