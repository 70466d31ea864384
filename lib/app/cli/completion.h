// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace landfall::cli {

struct Tool;

/// The name of the function that completes a tool: "_landfall_scan_sim".
[[nodiscard]] std::string completion_function(const std::string& tool);

/// A bash completion script for a tool whose options `app` has: it completes options, their values, files by
/// their extension, and after --set the keys of the tool's schema and their values. It needs only bash 4.
/// The script of a command, "landfall run", only defines the function.
[[nodiscard]] std::string bash_completion(const CLI::App& app, const Tool& tool);

}  // namespace landfall::cli
