// SPDX-License-Identifier: GPL-3.0-or-later
// landfall: starts every tool of landfall. Called by the name of a tool (a link to this program), it is that
// tool.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
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

fs::path own_folder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

/// Replaces this process. Returns only by throwing IoError.
[[noreturn]] void replace_by(const std::string& program, std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execvp(program.c_str(), argv.data());
  throw IoError("cannot start " + program + ": " + std::strerror(errno));
}

/// The folder of Makefile.studies: of the installation, or of the repository that this program was built in.
fs::path studies_folder() {
  for (fs::path folder = own_folder(); folder != folder.root_path(); folder = folder.parent_path())
    for (const fs::path& candidate : {folder / "share" / "landfall", folder})
      if (fs::exists(candidate / "Makefile.studies")) return candidate;
  throw IoError("there is no Makefile.studies above " + own_folder().string() +
                "; install landfall's studies");
}

constexpr std::array kStudyActions = {"status", "results", "partial", "clean"};

/// make's command for `landfall study [status|results|partial|clean] STUDY [ARGUMENTS OF make]`.
std::vector<std::string> study_command(const std::vector<std::string>& words) {
  std::size_t used = 0;
  std::string target = "study";
  if (!words.empty() && std::ranges::find(kStudyActions, words[0]) != kStudyActions.end())
    target += "-" + words[used++];
  if (used == words.size() || words[used].starts_with("-"))
    throw UsageError("study: a study is required: a file, or the name of one that ships (see --help)");
  std::string study = words[used++];
  if (fs::exists(study))
    study = fs::absolute(study).string();
  else if (study.find_first_of("./") != std::string::npos)
    throw UsageError("study " + study + ": no such file");
  std::vector<std::string> command = {"make",
                                      "--no-print-directory",
                                      "-C",
                                      studies_folder().string(),
                                      "-f",
                                      "Makefile.studies",
                                      target,
                                      "STUDY=" + study,
                                      "BIN=" + own_folder().string(),
                                      "RUNS=" + (fs::current_path() / "runs").string()};
  command.insert(command.end(), words.begin() + static_cast<std::ptrdiff_t>(used), words.end());
  return command;
}

/// Whether make says in a line only that a recipe failed, about which its command has said more.
bool is_echo_of_failure(const std::string& line) {
  const bool is_of_make = line.starts_with("make: ") || line.starts_with("make[");
  const bool names_recipe = line.find(": *** [") != std::string::npos;
  const bool is_count = line.ends_with("*** Waiting for unfinished jobs....") ||
                        line.ends_with(" not remade because of errors.");
  const bool is_lost_plan =
      line.starts_with("Makefile.studies:") && line.ends_with("study.mk: No such file or directory");
  return (is_of_make && (names_recipe || is_count)) || is_lost_plan;
}

/// Passes on what is written to `messages`, less those lines. The end of the other side ends it, no signal.
void pass_on_messages(int messages) {
  for (const int each : {SIGINT, SIGTERM, SIGHUP}) std::signal(each, SIG_IGN);
  std::FILE* const input = fdopen(messages, "r");
  std::string line;
  const auto pass_on = [&line] {
    const std::string text = line.ends_with('\n') ? line.substr(0, line.size() - 1) : line;
    if (!is_echo_of_failure(text)) std::fwrite(line.data(), 1, line.size(), stderr);
    line.clear();
  };
  for (int c = std::fgetc(input); c != EOF; c = std::fgetc(input)) {
    line += static_cast<char>(c);
    if (c == '\n') pass_on();
  }
  pass_on();
}

/// Sends stderr of this process, which make is about to replace, through a child. Stages show their progress
/// on the original, whose descriptor STUDY_STDERR names in Makefile.studies.
void filter_messages_of_make() {
  constexpr int kOriginal = 8;
  int ends[2];
  if (pipe(ends) != 0 || dup2(STDERR_FILENO, kOriginal) != kOriginal) return;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[1]);
    close(kOriginal);
    pass_on_messages(ends[0]);
    _exit(0);
  }
  if (child > 0) dup2(ends[1], STDERR_FILENO);
  close(ends[0]);
  close(ends[1]);
  setenv("STUDY_STDERR", std::to_string(kOriginal).c_str(), 1);
}

constexpr const char* kStudyHelp =
    R"(landfall study [status|results|partial|clean] STUDY [ARGUMENTS OF make]

Runs the parameter study of a file, or one that ships, by name, into runs/studies
of this folder; a run that was ended continues. docs/user/studies/README.md
describes studies.

  landfall study my.json -j2
  landfall study status my.json
  landfall study results my.json RUNS=/data/runs
)";

int run_study(const std::vector<std::string>& words) {
  if (!words.empty() && (words[0] == "-h" || words[0] == "--help")) {
    std::cout << kStudyHelp << std::flush;
    return 0;
  }
  const std::vector<std::string> command = study_command(words);
  filter_messages_of_make();
  replace_by("make", command);
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
  if (name == "study") return run_study(words);
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
