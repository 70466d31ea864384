// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/umbrella_page.h"

#include "cli/completion.h"
#include "cli/manual.h"
#include "cli/print.h"

namespace landfall::cli {
namespace {

constexpr const char* kPurpose =
    "landfall simulates a lander's scanning lidar, builds the elevation model that the lander would see, and "
    "judges it.";

/// `landfall` forgets its first word, so that the tool's function sees the command line of the tool.
constexpr const char* kUmbrellaBegin = R"sh(_landfall_landfall() {
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W "$_landfall_commands" -- "${COMP_WORDS[1]}"))
    return
  fi
  local tool=
  case ${COMP_WORDS[1]} in
)sh";

constexpr const char* kUmbrellaEnd =
    R"sh(    *) COMPREPLY=($(compgen -f -- "${COMP_WORDS[COMP_CWORD]}")); return ;;
  esac
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

bool has_tool(const CommandEntry& command) { return *command.tool != '\0'; }

}  // namespace

std::string umbrella_help(std::span<const CommandEntry> commands) {
  std::string text = std::string(kPurpose) + "\n\nlandfall COMMAND [OPTION...]\n\n";
  for (const CommandEntry& command : commands) text += print("  %-12s %s\n", command.name, command.summary);
  return text +
         "\nlandfall help COMMAND lists a command's options, landfall --version prints the version.\n"
         "Documentation: man landfall, docs/user/landfall.md.\n";
}

std::string umbrella_manual(std::span<const CommandEntry> commands) {
  std::string text = manual_head("landfall", "landing lidar simulation: all tools by one name");
  text += ".SH SYNOPSIS\n\\fBlandfall\\fR \\fICOMMAND\\fR [\\fIOPTION\\fR...]\n.SH DESCRIPTION\n" +
          manual_text(kPurpose) + "\n.SH COMMANDS\n";
  for (const CommandEntry& command : commands)
    text += ".TP\n\\fB" + manual_text(command.name) + "\\fR\n" + manual_text(command.summary) + ".\n";
  text += ".SH EXIT STATUS\nThat of the tool; 2 for an unknown command.\n.SH EXAMPLES\n.EX\n" +
          manual_text("landfall scan-sim -c preset:paper --terrain terrain.h5 -o scan.h5") + "\n" +
          manual_text("landfall info scan.h5") + "\n.EE\n";
  return text + manual_see_also("landfall");
}

std::string umbrella_completion(std::span<const CommandEntry> commands, const std::string& own) {
  std::string names;
  std::string cases;
  for (const CommandEntry& command : commands) {
    names += (names.empty() ? "" : " ") + std::string(command.name);
    const std::string function = completion_function("landfall " + std::string(command.name));
    if (has_tool(command))
      cases += "    " + std::string(command.name) + ") tool=" + command.tool + " ;;\n";
    else if (own.find(function) != std::string::npos)
      cases += "    " + std::string(command.name) + ") tool='landfall " + command.name + "' ;;\n";
  }
  return own + "# bash completion of landfall\n_landfall_commands='" + names + "'\n" + kUmbrellaBegin +
         cases + kUmbrellaEnd;
}

}  // namespace landfall::cli
