// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace landfall::cli {

struct Tool;

/// The man page (section 1) of a tool whose options `app` has, in roff with the man macros: name, synopsis,
/// description, options, configuration from its schema, exit status, examples, files, other tools. It gives
/// the version but no date, so that equal programs have equal pages.
[[nodiscard]] std::string manual_page(const CLI::App& app, const Tool& tool);

}  // namespace landfall::cli
