// SPDX-License-Identifier: GPL-3.0-or-later
// landfall: starts every tool of landfall.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "app/cli/umbrella_page.h"
#include "base/core/error.h"
#include "base/dictionary/tables/tools.h"
#include "base/output/standard_streams.h"
#include "base/text/shown_text.h"
#include "store/config/schema.h"
#include "store/files/provenance.h"
#include "tools.h"
#include "watched_child.h"

namespace landfall {
std::filesystem::path own_folder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

namespace umbrella {
namespace {

namespace fs = std::filesystem;

/// Replaces this process by a program next to this one. Returns only by throwing IoError.
[[noreturn]] void start_beside(const std::string& name, const std::vector<std::string>& words) {
  std::vector<std::string> arguments = {(own_folder() / name).string()};
  arguments.insert(arguments.end(), words.begin(), words.end());
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  throw IoError("cannot start " + arguments[0] + ": " + std::strerror(errno));
}

/// Replaces this process by a command of the Python package, of the installation or of the repository.
[[noreturn]] void start_python(const std::string& script, const std::vector<std::string>& words) {
  setenv("LANDFALL_BIN", own_folder().c_str(), 0);
  const fs::path place = fs::path("python") / "commands" / script;
  for (fs::path folder = own_folder(); folder != folder.root_path(); folder = folder.parent_path())
    for (const fs::path& share : {folder / "share" / "landfall", folder})
      if (fs::exists(share / place)) start_beside(share / place, words);
  throw IoError("there is no " + place.string() + " above " + own_folder().string());
}

/// "landfall help", and "landfall help scan-sim" as `landfall scan-sim --help`.
int help(const std::vector<std::string>& words);

/// The completion of `landfall`, which contains that of `landfall run`.
int print_completion() {
  const std::array argv = {"landfall run", "--print-completion"};
  int code = 0;
  std::string own;
  {
    const CapturedOutput output;
    code = landfall_run::start(2, argv.data(), nullptr);
    own = output.text();
  }
  standard_output() << cli::umbrella_completion(own) << std::flush;
  return code;
}

/// `landfall run` in a child, for which memory may run out.
int run_watched(const std::vector<std::string>& words) {
  std::vector<const char*> argv = {"run"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  const auto run = [&] { return landfall_run::start(static_cast<int>(argv.size()), argv.data(), nullptr); };
  const ChildEnd end = end_of({"run", run, SIGKILL, 0});
  if (end.signal == SIGKILL)
    std::cerr << "landfall run: killed, as when memory runs out; the same command continues" << std::endl;
  return end_as(end);
}

int start(const std::string& name, const std::vector<std::string>& words) {
  if (name == "study") return landfall_study::run(words);
  if (name == "margin") start_python("margin.py", words);
  if (name == "help" || name == "-h" || name == "--help") return help(words);
  if (name == "-V" || name == "--version") {
    standard_output() << source_line("landfall") << std::endl;
    return 0;
  }
  if (name == "--print-completion") return print_completion();
  if (name == "--print-man") {
    standard_output() << cli::umbrella_manual() << std::flush;
    return 0;
  }
  if (name == "run") return run_watched(words);
  std::vector<std::string> known;
  for (const dictionary::Tool& tool : dictionary::kTools)
    if (tool.command == name)
      start_beside(tool.name, words);
    else if (*tool.command != '\0')
      known.emplace_back(tool.command);
  // A program that this version does not know.
  if (name[0] != '-' && fs::exists(own_folder() / ("landfall-" + name)))
    start_beside("landfall-" + name, words);
  const std::string near = nearest_word(name, known);
  throw UsageError("'" + shown_word(name) + "' is not a command; " +
                   (near.empty() ? "landfall help lists them" : "did you mean " + near + "?"));
}

int help(const std::vector<std::string>& words) {
  if (!words.empty() && words[0] != "help") return start(words[0], {"--help"});
  standard_output() << cli::umbrella_help() << std::flush;
  return 0;
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* /*invocation*/) {
  try {
    if (argc < 2) throw UsageError("a command is required; landfall help lists them");
    return start(argv[1], {argv + 2, argv + argc});
  } catch (const Error& error) {
    std::cerr << shown_text(std::string("landfall: ") + error.what()) << '\n';
    return static_cast<int>(error.exit_code());
  }
}

}  // namespace umbrella
}  // namespace landfall
