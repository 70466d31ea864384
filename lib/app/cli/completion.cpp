// SPDX-License-Identifier: GPL-3.0-or-later
// Completion needs only bash. After `--set KEY=` it offers texts with the backslashes that a shell needs
// before the quotes of JSON.
#include "app/cli/completion.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <set>

#include "app/cli/option_view.h"
#include "app/cli/tool.h"
#include "base/text/joined.h"
#include "store/config/schema.h"
#include "store/config/schema_keys.h"
#include "store/config/stage_sections.h"

namespace landfall::cli {
namespace {

using Values = std::map<std::string, std::set<std::string>>;  ///< values of each key, as JSON

constexpr const char* kHelpers =
    R"sh(_landfall_match() {  # CURRENT CANDIDATE...: a text may be begun without its quote
  local current=$1 candidate
  shift
  for candidate; do
    if [[ $candidate == "$current"* || $candidate == '\"'"$current"* ]]; then COMPREPLY+=("$candidate"); fi
  done
}
_landfall_files() {  # CURRENT EXTENSION
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -f -X "!*$2" -- "$1"; compgen -d -- "$1")
}
)sh";

/// bash splits words at "=": --set KEY = VALUE.
constexpr const char* kBegin = R"sh(() {
  local current=${COMP_WORDS[COMP_CWORD]} at=$((COMP_CWORD - 1)) option key= assigned=
  COMPREPLY=()
  if [[ $current == = ]]; then
    current= assigned=1
  elif [[ ${COMP_WORDS[at]} == = ]]; then
    at=$((at - 1)) assigned=1
  fi
  option=${COMP_WORDS[at]}
  if [[ $assigned && at -gt 0 && $option != -* ]]; then
    key=$option option=${COMP_WORDS[at - 1]}
    if [[ $option == = && at -gt 1 ]]; then option=${COMP_WORDS[at - 2]}; fi
  fi
  case $option in
)sh";

/// Encloses a word in single quotes, which no option, value or key contains.
std::string quoted(const std::string& word) { return "'" + word + "'"; }

template <class Words>
std::string match(const Words& words) {
  std::string text = "_landfall_match \"$current\"";
  for (const std::string& word : words) text += " " + quoted(word);
  return text;
}

/// Escapes JSON as typed in a shell: its quotes need a backslash.
std::string in_shell(const std::string& json) {
  std::string text;
  for (const char c : json) text += c == '"' ? "\\\"" : std::string(1, c);
  return text;
}

/// The path with index 0 for any element of an array.
std::string path_of(const SchemaKey& key) {
  std::string path = key.path;
  for (std::size_t at = path.find(".N"); at != std::string::npos; at = path.find(".N", at + 2))
    if (at + 2 == path.size() || path[at + 2] == '.') path[at + 1] = '0';
  return path;
}

void add_values(Values& values, const std::string& schema, const std::string& prefix) {
  for (const SchemaKey& key : schema_keys(embedded_schema(schema))) {
    if (key.type.empty()) continue;
    std::set<std::string>& all = values[prefix + path_of(key)];
    for (const std::string& value : key.values) all.insert(in_shell(value));
    if (key.type == "boolean") all.insert({"false", "true"});
  }
}

Values values_of(const Tool& tool) {
  Values values;
  add_values(values, tool.schema, "");
  if (has_stage_sections(tool.schema))
    for (const std::string& stage : stage_sections(tool.schema)) add_values(values, stage, stage + ".");
  return values;
}

std::string set_case(const Tool& tool) {
  const Values values = values_of(tool);
  std::set<std::string> keys;
  std::string cases;
  for (const auto& [key, words] : values) {
    keys.insert(key + "=");
    if (!words.empty()) cases += "        " + key + ") " + match(words) + " ;;\n";
  }
  return "    --set)\n      case $key in\n        '')\n          compopt -o nospace 2>/dev/null\n          " +
         match(keys) + "\n          ;;\n" + cases + "      esac\n      ;;\n";
}

/// The file extension that an option accepts; empty for any.
std::string extension_of(const OptionView& option) {
  if (option.names.back() == "--config") return ".json";
  return option.description.find(".h5)") != std::string::npos ? ".h5" : "";
}

std::string option_case(const OptionView& option) {
  std::string action = ":";
  if (!option.values.empty())
    action = match(option.values);
  else if (option.type.substr(0, 4) == "FILE")
    action = "_landfall_files \"$current\" " + quoted(extension_of(option));
  return "    " + joined(option.names, "|") + ") " + action + " ;;\n";
}

}  // namespace

std::string completion_function(const std::string& tool) {
  std::string function = "_landfall_" + tool;
  std::ranges::replace_if(
      function, [](char c) { return c == '-' || c == ' '; }, '_');
  return function;
}

std::string bash_completion(const CLI::App& app, const Tool& tool) {
  const std::string function = completion_function(tool.name);
  std::string text = "# bash completion of " + tool.name + "\n" + kHelpers + function + kBegin;
  std::vector<std::string> names;
  std::string argument = ":";
  for (const OptionView& option : options_of(app)) {
    if (option.positional) {
      argument = "_landfall_files \"$current\" '.h5'";
      continue;
    }
    names.insert(names.end(), option.names.begin(), option.names.end());
    if (option.names.back() == "--set")
      text += set_case(tool);
    else if (option.takes_value)
      text += option_case(option);
  }
  return text + "    *)\n      if [[ $current == -* ]]; then\n        " + match(names) +
         "\n      else\n        " + argument + "\n      fi\n      ;;\n  esac\n}\n" +
         (tool.name.find(' ') == std::string::npos ? "complete -F " + function + " " + tool.name + "\n" : "");
}

}  // namespace landfall::cli
