// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/umbrella_page.h"

#include <vector>

#include "app/cli/completion.h"
#include "app/cli/manual.h"
#include "app/cli/print.h"
#include "base/dictionary/tables/tools.h"

namespace landfall::cli {
namespace {

constexpr const char* kPurpose =
    "landfall simulates a lander's scanning lidar, builds the elevation model that the lander would see, and "
    "judges it.";

/// `landfall` forgets its first word, so that the tool's function sees the command line of the tool. The
/// options of a command of Python are read from its --help, once in a shell.
constexpr const char* kUmbrellaBegin = R"sh(declare -A _landfall_python_options
_landfall_python() {  # COMMAND
  local current=${COMP_WORDS[COMP_CWORD]}
  if [[ $current != -* ]]; then _landfall_files "$current" ''; return; fi
  if [[ ! ${_landfall_python_options[$1]} ]]; then
    _landfall_python_options[$1]=$("${COMP_WORDS[0]}" $1 --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]*' | sort -u)
  fi
  COMPREPLY=($(compgen -W "${_landfall_python_options[$1]}" -- "$current"))
}
_landfall_landfall() {
  local second="${COMP_WORDS[1]} ${COMP_WORDS[2]}" command tool=
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W "$(cut -d' ' -f1 <<<"$_landfall_commands")" -- "${COMP_WORDS[1]}"))
    return
  fi
  if ((COMP_CWORD == 2)) && command=$(sed -n "s/^${COMP_WORDS[1]//[^a-z-]/.} //p" <<<"$_landfall_commands") && [[ $command ]]; then
    COMPREPLY=($(compgen -W "$command" -- "${COMP_WORDS[2]}"))
    if [[ ${COMP_WORDS[1]} == study ]]; then COMPREPLY+=($(compgen -f -- "${COMP_WORDS[2]}")); fi
    return
  fi
  for command in "$second" "${COMP_WORDS[1]}"; do
    case $command in
)sh";

constexpr const char* kUmbrellaEnd =
    R"sh(    esac
  done
  if [[ ! $tool ]]; then _landfall_files "${COMP_WORDS[COMP_CWORD]}" ''; return; fi
  local function=_landfall_${tool//[- ]/_}
  if ! declare -F "$function" >/dev/null; then
    local folder
    for folder in "$_landfall_folder" /usr/share/bash-completion/completions; do
      if [[ -r $folder/$tool ]]; then source "$folder/$tool"; break; fi
    done
  fi
  declare -F "$function" >/dev/null || return
  COMP_WORDS=("$tool" "${COMP_WORDS[@]:2}")
  COMP_CWORD=$((COMP_CWORD - 1))
  "$function"
}
_landfall_folder=${BASH_SOURCE[0]%/*}
complete -F _landfall_landfall landfall
)sh";

/// The rows of tools.json that are commands of `landfall`.
std::vector<dictionary::Tool> commands() {
  std::vector<dictionary::Tool> found;
  for (const dictionary::Tool& tool : dictionary::kTools)
    if (*tool.command != '\0') found.push_back(tool);
  return found;
}

bool is_program(const std::string& name) { return name.find(' ') == std::string::npos; }

}  // namespace

std::string umbrella_help(const std::string& group) {
  const std::string begin = group.empty() ? "" : group + " ";
  std::string list;
  for (const dictionary::Tool& command : commands())
    if (const std::string name = command.command;
        name.starts_with(begin) && name.find(' ', begin.size()) == std::string::npos)
      list += print("  %-11s  %s\n", command.command + begin.size(), command.brief);
  if (!group.empty()) return list.empty() ? "" : "landfall " + group + " COMMAND [OPTION...]\n\n" + list;
  return std::string(kPurpose) + "\n\nlandfall COMMAND [OPTION...]\n\n" + list +
         "\nlandfall help COMMAND lists a command's options, landfall --version prints the version.\n"
         "Documentation: man landfall, docs/user/landfall.md.\n";
}

std::string umbrella_manual() {
  std::string text = manual_head("landfall", dictionary::kTools.front().summary);
  text += ".SH SYNOPSIS\n\\fBlandfall\\fR \\fICOMMAND\\fR [\\fIOPTION\\fR...]\n.SH DESCRIPTION\n" +
          manual_text(kPurpose) + "\n.SH COMMANDS\n";
  for (const dictionary::Tool& command : commands())
    text += ".TP\n\\fB" + manual_text(command.command) + "\\fR\n" + manual_text(command.brief) + ".\n";
  text += ".SH EXIT STATUS\nThat of the tool; 2 for an unknown command.\n.SH EXAMPLES\n.EX\n" +
          manual_text("landfall scan-sim -c preset:paper --terrain terrain.h5 -o scan.h5") + "\n" +
          manual_text("landfall info scan.h5") + "\n.EE\n";
  return text + manual_see_also("landfall");
}

std::string umbrella_completion(const std::string& own) {
  std::string names;
  std::string cases;
  for (const dictionary::Tool& command : commands()) {
    const std::string name = command.command;
    const std::string tool = command.name;
    names += (names.empty() ? "" : "\n") + name;
    if (*command.module != '\0')
      cases += "      '" + name + "') _landfall_python '" + name + "'; return ;;\n";
    else if (is_program(tool) || own.find(completion_function(tool)) != std::string::npos)
      cases += "      '" + name + "') tool='" + tool + "'; break ;;\n";
  }
  return own + "# bash completion of landfall\n_landfall_commands='" + names + "'\n" + kUmbrellaBegin +
         cases + kUmbrellaEnd;
}

}  // namespace landfall::cli
