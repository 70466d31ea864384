// SPDX-License-Identifier: GPL-3.0-or-later
// Command-line input is UTF-8, including file names: all of it may appear in provenance, in a summary or
// in a message, and JSON is UTF-8. A file whose name is not UTF-8 is refused with the number of the
// argument before anything is read; it can be renamed. In a file, bytes of a text that are not UTF-8 are
// read as U+FFFD, because units and titles of other programs are often Latin-1; an object name that is not
// UTF-8 is refused.
#include "app/cli/command_line.h"

#include <regex.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "base/core/error.h"
#include "store/config/schema.h"

namespace landfall::cli {
namespace {

/// The type in the option's declaration, without the text that its checks add.
std::string wanted(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::string word = type.substr(0, type.find(':'));
  if (word == "FILE" || word == "FILE...") return "a file";
  return word.empty() || word == "TEXT" ? "a value" : word;
}

/// A positional argument has no name that a user could type.
std::string name_of(const CLI::Option& option) {
  return (option.get_positional() ? "the argument " : "") + option.get_name();
}

std::string wants(const CLI::App& app, const std::string& name) {
  const CLI::Option* const option = app.get_option_no_throw(name);
  return option == nullptr ? name + " needs a value" : name_of(*option) + " needs " + wanted(*option);
}

std::string spaced(std::string list) {
  for (std::size_t at = list.find(','); at != std::string::npos; at = list.find(',', at + 2))
    list.replace(at, 1, ", ");
  return list;
}

bool is_flag(const CLI::App& app, const std::string& name) {
  const CLI::Option* const option = app.get_option_no_throw(name);
  return option != nullptr && option->get_items_expected_max() == 0;
}

/// The parser may report `arguments` in another order than they were given.
std::string not_expected(const CLI::App& app, const std::string& arguments) {
  std::istringstream words(arguments);
  std::string word;
  while (words >> word && word.front() != '-') continue;
  if (arguments == "help") return "'help' is not a command of this tool; did you mean --help?";
  if (word.empty() || word.front() != '-') return "'" + arguments + "' is one argument too many";
  const std::string name = word.substr(0, word.find('='));
  std::vector<std::string> known;
  for (const CLI::Option* const option : app.get_options()) known.push_back(option->get_name());
  const std::string near = nearest_word(name, known);
  return "unknown option " + name + (near.empty() ? "" : "; did you mean " + near + "?");
}

/// The text and the groups of an extended regular expression that matches all of it; none where it does not.
/// The C library's: g++ takes 2 s to compile std::regex.
std::vector<std::string> matched(const std::string& text, const std::string& pattern) {
  std::array<regmatch_t, 8> spans;
  regex_t expression;
  if (regcomp(&expression, ("^" + pattern + "$").c_str(), REG_EXTENDED) != 0)
    throw std::logic_error("no expression: " + pattern);
  const bool found = regexec(&expression, text.c_str(), spans.size(), spans.data(), 0) == 0;
  regfree(&expression);
  std::vector<std::string> groups;
  for (const regmatch_t& span : spans)
    if (found && span.rm_so >= 0)
      groups.emplace_back(text, static_cast<std::size_t>(span.rm_so),
                          static_cast<std::size_t>(span.rm_eo - span.rm_so));
  return groups;
}

}  // namespace

void require_values(const CLI::App& app) {
  for (const CLI::Option* const option : app.get_options()) {
    const std::vector<std::string>& values = option->results();
    if (std::ranges::find(values, "") != values.end())
      throw UsageError(name_of(*option) + " needs " + wanted(*option));
  }
}

std::string plain_message(const CLI::App& app, const CLI::ParseError& error) {
  const std::string text = error.what();
  std::vector<std::string> part;
  const auto is = [&](const char* pattern) { return !(part = matched(text, pattern)).empty(); };
  if (is("The following arguments? (was|were) not expected: (.*)")) return not_expected(app, part[2]);
  if (is("(\\S+): 1 required .* missing")) return wants(app, part[1]);
  if (is("Could not convert: (\\S+) = (.*)"))
    return is_flag(app, part[1]) ? part[1] + " does not take a value"
                                 : part[1] + ": '" + part[2] + "' is not a number";
  if (is("(\\S+): Value (.*) not in range \\[?(\\S+) (to|-) ([^][:space:]]+)]?"))
    return part[1] + ": " + part[2] + " is not in [" + part[3] + ", " + part[5] + "]";
  if (is("(\\S+): (.*) not in \\{(.*)\\}"))
    return part[1] + ": " + part[2] + " is not one of " + spaced(part[3]);
  if (is("(\\S+) requires (\\S+)")) return part[1] + " needs " + part[2];
  if (is("(\\S+) excludes (\\S+)")) return part[1] + " and " + part[2] + " are mutually exclusive";
  if (is("(\\S+): At Most 1 required but received ([0-9]+)"))
    return part[1] + " is given " + part[2] + " times; give it once";
  if (is("(\\S+)(: Should be true/false or a number| was given a disallowed flag override|"
         ": too many inputs for a flag)"))
    return part[1] + " does not take a value";
  return text;
}

}  // namespace landfall::cli
