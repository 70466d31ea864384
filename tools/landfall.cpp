// SPDX-License-Identifier: GPL-3.0-or-later
// landfall: starts every tool of landfall. Called by the name of a tool (a link to this program), it is that
// tool.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/shown_text.h"
#include "cli/standard_streams.h"
#include "cli/umbrella_page.h"
#include "config/schema.h"
#include "files/provenance.h"
#include "tools.h"

namespace landfall {
std::filesystem::path own_folder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

namespace {

namespace fs = std::filesystem;

struct Command {
  cli::CommandEntry entry;
  ToolFunction* function;
};

constexpr std::array kCommands = {
    Command{{"run", "", "Runs the whole chain from one configuration"}, landfall_run::start},
    Command{{"terrain-gen", "terrain-gen", "Builds the true terrain of a landing site"}, terrain_gen::start},
    Command{{"scan-sim", "scan-sim", "Scans a terrain with a lander's lidar"}, scan_sim::start},
    Command{{"regrid", "regrid", "Grids the returns of scans into a DEM"}, regrid::start},
    Command{{"dem-eval", "dem-eval", "Judges a DEM against landing requirements"}, dem_eval::start},
    Command{{"hazard-map", "hazard-map", "Finds safe places to land on a DEM"}, hazard_map::start},
    Command{{"monte-carlo", "monte-carlo", "Draws the errors many times and counts passes"},
            monte_carlo::start},
    Command{{"info", "landfall-info", "Describes landfall files"}, landfall_info::start},
    Command{{"export", "landfall-export", "Converts a landfall file for other programs"},
            landfall_export::start},
    Command{{"import", "landfall-import", "Imports points or a DEM to judge them"}, landfall_import::start}};

constexpr cli::CommandEntry kStudy = {"study", "", "Runs a parameter study: landfall study FILE [-j N]"};
constexpr cli::CommandEntry kHelp = {"help", "", "Lists the commands; with a command, its options"};

std::vector<cli::CommandEntry> entries() {
  std::vector<cli::CommandEntry> all;
  for (const Command& command : kCommands) all.push_back(command.entry);
  all.insert(all.end(), {kStudy, kHelp});
  return all;
}

const Command* find(const std::string& name) {
  const auto* const found =
      std::ranges::find_if(kCommands, [&](const Command& c) { return c.entry.name == name; });
  return found == kCommands.end() ? nullptr : found;
}

/// Replaces this process. Returns only by throwing IoError.
[[noreturn]] void replace_by(const std::string& program, std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execvp(program.c_str(), argv.data());
  throw IoError("cannot start " + program + ": " + std::strerror(errno));
}

/// "landfall help", and "landfall help scan-sim" as `landfall scan-sim --help`.
int help(const std::vector<std::string>& words);

/// The completion of `landfall`, which contains that of `landfall run`.
int print_completion() {
  const std::array argv = {"landfall run", "--print-completion"};
  int code = 0;
  std::string own;
  {
    const cli::CapturedOutput output;
    code = landfall_run::start(2, argv.data(), nullptr);
    own = output.text();
  }
  std::cout << cli::umbrella_completion(entries(), own) << std::flush;
  return code;
}

int start(const std::string& name, const std::vector<std::string>& words) {
  if (name == "study") return landfall_study::run(words);
  if (name == "help" || name == "-h" || name == "--help") return help(words);
  if (name == "-V" || name == "--version") {
    std::cout << source_line("landfall") << std::endl;
    return 0;
  }
  if (name == "--print-completion") return print_completion();
  if (name == "--print-man") {
    std::cout << cli::umbrella_manual(entries()) << std::flush;
    return 0;
  }
  if (const Command* const command = find(name)) {
    std::vector<const char*> argv = {command->entry.name};
    for (const std::string& word : words) argv.push_back(word.c_str());
    return command->function(static_cast<int>(argv.size()), argv.data(), nullptr);
  }
  // A program beside this one that this version does not contain.
  if (const fs::path beside = own_folder() / ("landfall-" + name); name[0] != '-' && fs::exists(beside)) {
    std::vector<std::string> arguments = {beside.string()};
    arguments.insert(arguments.end(), words.begin(), words.end());
    replace_by(beside.string(), arguments);
  }
  std::vector<std::string> known;
  for (const cli::CommandEntry& entry : entries()) known.emplace_back(entry.name);
  const std::string near = nearest_word(name, known);
  throw UsageError("'" + shown_word(name) + "' is not a command; " +
                   (near.empty() ? "landfall help lists them" : "did you mean " + near + "?"));
}

int help(const std::vector<std::string>& words) {
  if (!words.empty() && words[0] != "help") return start(words[0], {"--help"});
  std::cout << cli::umbrella_help(entries()) << std::flush;
  return 0;
}

int start(const std::vector<std::string>& words) {
  try {
    if (words.empty()) throw UsageError("a command is required; landfall help lists them");
    return start(words[0], {words.begin() + 1, words.end()});
  } catch (const Error& error) {
    std::cerr << shown_text(std::string("landfall: ") + error.what()) << '\n';
    return static_cast<int>(error.exit_code());
  }
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  const std::string name = argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "landfall";
  const auto* const tool = std::ranges::find_if(
      landfall::kCommands, [&](const landfall::Command& command) { return command.entry.tool == name; });
  if (tool != landfall::kCommands.end()) return tool->function(argc, argv, nullptr);
  return landfall::start({argv + 1, argv + argc});
}
