// SPDX-License-Identifier: GPL-3.0-or-later
// Man pages, completion and help come from the declarations of the options and from the schema that checks
// a configuration, and are printed by the tool itself, so that they cannot diverge. A page has no date:
// equal programs have equal pages. A definition that is used by several keys is printed at the first one.
#include "app/cli/manual.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <sstream>

#include "app/cli/option_view.h"
#include "app/cli/tool.h"
#include "base/dictionary/tables/tools.h"
#include "base/text/joined.h"
#include "store/config/schema.h"
#include "store/config/schema_keys.h"
#include "store/files/provenance.h"

namespace landfall::cli {
namespace {

/// Escapes text so that roff prints it unchanged, and so that it can be copied into a shell.
std::string roff(const std::string& text) {
  static const std::map<char, const char*> kEscapes = {{'\\', "\\e"},  {'-', "\\-"},   {'\'', "\\(aq"},
                                                       {'"', "\\(dq"}, {'^', "\\(ha"}, {'~', "\\(ti"},
                                                       {'`', "\\(ga"}};
  std::string result;
  for (const char c : text) {
    const auto escape = kEscapes.find(c);
    result += escape == kEscapes.end() ? std::string(1, c) : escape->second;
  }
  return !result.empty() && result.front() == '.' ? "\\&" + result : result;
}

std::string upper(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

/// "landfall-run": a page's name has no blank.
std::string page_name(std::string name) {
  std::ranges::replace(name, ' ', '-');
  return name;
}

/// A summary in the form of man page indexes: without capital and full stop.
std::string name_line(const Tool& tool) {
  std::string text = tool.summary;
  if (text.ends_with('.')) text.pop_back();
  if (text.front() >= 'A' && text.front() <= 'Z') text.front() = static_cast<char>(text.front() - 'A' + 'a');
  return text;
}

std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + roff(text) + "\\fR"; }

std::string option_lines(const OptionView& option) {
  std::string text = ".TP\n" + joined(option.names, ", ", bold);
  if (!option.type.empty()) text += " " + italic(option.type);
  if (!option.values.empty()) text += " " + roff("{" + joined(option.values) + "}");
  text += "\n" + roff(option.description) + (option.description.ends_with('.') ? "" : ".");
  if (!option.default_value.empty()) text += " Default: " + roff(option.default_value) + ".";
  return text + "\n";
}

std::string synopsis(const Tool& tool, const std::vector<OptionView>& options) {
  std::string text = ".SH SYNOPSIS\n" + bold(tool.name) + " [" + italic("OPTION") + "...]";
  for (const OptionView& option : options)
    if (option.positional) text += " [" + italic(option.type) + "]";
  return text + "\n";
}

std::string option_section(const std::vector<OptionView>& options) {
  std::string text = ".SH OPTIONS\n";
  std::string group;
  for (const OptionView& option : options) {
    if (option.group != group && option.group != "Options") text += ".SS " + roff(option.group) + "\n";
    group = option.group;
    text += option_lines(option);
  }
  return text;
}

/// "number, m, above 0; default 5".
std::string facts(const SchemaKey& key) {
  std::string text = key.type;
  if (!key.unit.empty()) text += ", " + key.unit;
  if (!key.bounds.empty()) text += ", " + key.bounds;
  if (!key.values.empty()) text = "one of " + joined(key.values);
  if (!key.default_value.empty()) text += "; default " + key.default_value;
  return text;
}

std::string sentence(const std::string& text) {
  return text.empty() ? "\\&\n" : roff(text) + (text.ends_with('.') ? "\n" : ".\n");
}

std::string key_lines(const SchemaKey& key) {
  const std::string head = ".TP\n" + bold(key.path);
  if (key.type.empty())
    return head + " of type " + bold("\"" + key.choice + "\"") + "\n" + sentence(key.description);
  return head + " (" + roff(facts(key)) + ")\n" + sentence(key.description);
}

/// Indents the keys of one choice of "type" under its heading.
std::string indented_keys(const std::vector<SchemaKey>& keys) {
  std::string text;
  std::vector<std::string> heads;
  for (const SchemaKey& key : keys) {
    const bool is_head = key.type.empty();
    while (!heads.empty() &&
           (!key.path.starts_with(heads.back() + ".") || (is_head && key.path == heads.back()))) {
      text += ".RE\n";
      heads.pop_back();
    }
    text += key_lines(key);
    if (!is_head) continue;
    text += ".RS\n";
    heads.push_back(key.path);
  }
  for (std::size_t i = 0; i < heads.size(); ++i) text += ".RE\n";
  return text;
}

std::string configuration_section(const Tool& tool) {
  if (tool.schema.empty()) return "";
  std::string text = ".SH CONFIGURATION\nA JSON object, given by " + bold("--config") + " and " +
                     bold("--set") + ". Each key is written as " + bold("--set") +
                     " takes it; N is an index from 0. Unknown keys and values out of bounds are refused. " +
                     bold("--print-config") + " shows the resolved configuration, " + bold("--print-schema") +
                     " the JSON schema that these lines are made from.\n";
  return text + indented_keys(schema_keys(embedded_schema(tool.schema)));
}

/// "--require-pass:" and the like in bold.
std::string with_bold_options(const std::string& text) {
  std::string result;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const bool has_colon = word.ends_with(':');
    const std::string option = word.substr(0, word.size() - (has_colon ? 1 : 0));
    result += (result.empty() ? "" : " ") +
              (word.starts_with("--") ? bold(option) + (has_colon ? ":" : "") : roff(word));
  }
  return result;
}

std::string exit_section(const Tool& tool) {
  std::string text =
      ".SH EXIT STATUS\n.TP\n.B 0\nDone.\n.TP\n.B 1\nThe content of a data file is wrong, or "
      "reading or writing failed.\n.TP\n.B 2\nA flag or the configuration is wrong, or the output "
      "exists.\n";
  if (!tool.exit_3.empty()) text += ".TP\n.B 3\n" + with_bold_options(tool.exit_3) + "\n";
  return text;
}

std::string environment_section(const Tool& tool) {
  if (tool.plugin.empty()) return "";
  return ".SH ENVIRONMENT\n.TP\n.B LANDFALL_PLUGIN_DIR\nThe directory of " + roff(tool.plugin) +
         ", which reads and writes rasters; by default that of the installation.\n";
}

/// Indented lines are commands; the other lines are prose after them.
std::string example_section(const Tool& tool) {
  std::string commands;
  std::string prose;
  std::istringstream lines(tool.examples);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("  "))
      commands += roff(line.substr(2)) + "\n";
    else if (line != "Examples:")
      prose += roff(line) + "\n";
  }
  return ".SH EXAMPLES\n.EX\n" + commands + ".EE\n" + (prose.empty() ? "" : ".PP\n" + prose);
}

/// Paragraphs are separated by empty lines.
std::string paragraphs(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) result += line.empty() ? ".PP\n" : roff(line) + "\n";
  return result;
}

}  // namespace

std::string manual_text(const std::string& text) { return roff(text); }

std::string manual_head(const std::string& name, const std::string& summary) {
  return ".TH " + upper(name) + " 1 \"\" \"landfall " + program_version() +
         "\" \"landfall\"\n.nh\n.ad l\n.SH NAME\n" + roff(name) + " \\- " + roff(summary) + "\n";
}

std::string manual_see_also(const std::string& name) {
  std::string text;
  for (const dictionary::Tool& other : dictionary::kTools)
    if (const std::string page = page_name(other.name); *other.summary != '\0' && page != name)
      text += (text.empty() ? "" : ",\n") + std::string(".BR ") + roff(page) + " (1)";
  return ".SH SEE ALSO\n" + text + "\n";
}

std::string manual_page(const CLI::App& app, const Tool& tool) {
  const std::vector<OptionView> options = options_of(app);
  std::string text = manual_head(page_name(tool.name), name_line(tool)) + synopsis(tool, options);
  text += ".SH DESCRIPTION\n" + paragraphs(tool.description.empty() ? tool.summary : tool.description);
  text += option_section(options) + configuration_section(tool) + exit_section(tool) +
          environment_section(tool) + example_section(tool);
  text +=
      ".SH FILES\nEvery file is HDF5; docs/user/files/ of the documentation describes its contents, and\n.BR "
      "landfall\\-info (1)\nprints them.\n";
  return text + manual_see_also(page_name(tool.name));
}

}  // namespace landfall::cli
