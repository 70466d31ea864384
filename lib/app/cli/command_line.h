// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace landfall::cli {

/// Throws UsageError for an option with an empty value ("--terrain wants a file"), which is most often a
/// shell variable that is not set. Call it after the command line is parsed.
void require_values(const CLI::App& app);

/// The parser's error in the style of all other messages; names the option and, if it has a fixed set of
/// values, those values.
[[nodiscard]] std::string plain_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace landfall::cli
