// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

namespace cli {
struct Invocation;
}

/// A tool as a function: its program and `landfall run` call it. Returns the exit code. `invocation` may be
/// null.
using ToolFunction = int(int argc, const char* const* argv, cli::Invocation* invocation);

// Each in a namespace of its own: its program's main function calls it (main.cpp).
namespace umbrella {  // `landfall`
ToolFunction start;
}
namespace terrain_gen {
ToolFunction start;
}
namespace scan_sim {
ToolFunction start;
}
namespace regrid {
ToolFunction start;
}
namespace dem_eval {
ToolFunction start;
}
namespace hazard_map {
ToolFunction start;
}
namespace monte_carlo {
ToolFunction start;
}
namespace landfall_info {
ToolFunction start;
}
namespace landfall_export {
ToolFunction start;
}
namespace landfall_import {
ToolFunction start;
}
namespace landfall_run {  // `landfall run`
ToolFunction start;
}

}  // namespace landfall
