// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace landfall::cli {

/// Throws UsageError for an option that was given an empty text ("--terrain wants a file"): most often a
/// shell variable that is not set. Call it after the command line is parsed.
void require_values(const CLI::App& app);

/// The parser's refusal of a command line in the words of all other messages; names the option and, where it
/// is one of a few, what it takes.
[[nodiscard]] std::string plain_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace landfall::cli
