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

// Parts of a man page.
/// The title lines and the section NAME.
[[nodiscard]] std::string manual_head(const std::string& name, const std::string& summary);
/// Text as roff prints it unchanged.
[[nodiscard]] std::string manual_text(const std::string& text);
/// The section SEE ALSO: all tools but `name`.
[[nodiscard]] std::string manual_see_also(const std::string& name);

}  // namespace landfall::cli
