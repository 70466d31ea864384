// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

namespace cli {
struct Invocation;
}

/// A tool as a function: its own program calls it, and so does `landfall`. Returns the exit code.
/// `invocation` may be null.
using ToolFunction = int(int argc, const char* const* argv, cli::Invocation* invocation);

ToolFunction terrain_gen;
ToolFunction scan_sim;
ToolFunction regrid;
ToolFunction dem_eval;
ToolFunction hazard_map;
ToolFunction monte_carlo;
ToolFunction landfall_info;
ToolFunction landfall_export;
ToolFunction landfall_import;

/// `landfall run`, which has no program of its own.
ToolFunction landfall_run;

}  // namespace landfall
