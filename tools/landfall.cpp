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
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "app/cli/umbrella_page.h"
#include "base/core/error.h"
#include "base/core/standard_streams.h"
#include "base/dictionary/tables/tools.h"
#include "base/text/shown_text.h"
#include "landfall_study.h"
#include "store/config/schema.h"
#include "store/files/provenance.h"
#include "tools.h"
#include "watched_child.h"

namespace landfall {
namespace fs = std::filesystem;

fs::path own_folder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

fs::path shared_folder(const fs::path& file) {
  for (fs::path folder = own_folder(); folder != folder.root_path(); folder = folder.parent_path())
    for (const fs::path& candidate : {folder / "share" / "landfall", folder})
      if (fs::exists(candidate / file)) return candidate;
  throw IoError("there is no " + file.string() + " above " + own_folder().string() +
                "; install all of landfall");
}

namespace umbrella {
namespace {

constexpr const char* kPython = "/usr/bin/python3";  // Debian's, which has the modules of its packages

using Words = std::vector<std::string>;

/// Replaces this process by a program. Returns only by throwing IoError.
[[noreturn]] void become(const std::string& program, Words arguments, const Words& words) {
  arguments.insert(arguments.end(), words.begin(), words.end());
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  throw IoError("cannot start " + program + ": " + std::strerror(errno));
}

/// Replaces this process by a program next to this one.
[[noreturn]] void start_beside(const std::string& name, const Words& words) {
  const std::string program = (own_folder() / name).string();
  become(program, {program}, words);
}

/// Replaces this process by a command of the Python package, which uses the tools next to this program.
[[noreturn]] void start_python(const std::string& command, const Words& words) {
  const fs::path start = fs::path("python") / "start.py";
  setenv("LANDFALL_BIN", own_folder().c_str(), 0);
  become(kPython, {kPython, (shared_folder(start) / start).string(), command}, words);
}

/// "landfall help", and "landfall help scan-sim" as `landfall scan-sim --help`.
int help(const Words& words);

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
int run_watched(const Words& words) {
  std::vector<const char*> argv = {"run"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  const auto run = [&] { return landfall_run::start(static_cast<int>(argv.size()), argv.data(), nullptr); };
  const ChildEnd end = end_of({"run", run, SIGKILL, 0});
  if (end.signal == SIGKILL)
    std::cerr << "landfall run: killed, as when memory runs out; the same command continues" << std::endl;
  return end_as(end);
}

/// Whether these are the first words of a command line.
bool begins_with(const Words& words, const Words& first) {
  return words.size() >= first.size() && std::equal(first.begin(), first.end(), words.begin());
}

/// The words of a command: "plot", "dem".
Words words_of(const std::string& command) {
  std::istringstream text(command);
  return {std::istream_iterator<std::string>(text), {}};
}

/// The row of the longest command that a command line begins with; null if it begins with none.
const dictionary::Tool* command_of(const Words& line) {
  const dictionary::Tool* found = nullptr;
  for (const dictionary::Tool& tool : dictionary::kTools) {
    const Words words = words_of(tool.command);
    if (words.empty() || !begins_with(line, words)) continue;
    if (found == nullptr || words.size() > words_of(found->command).size()) found = &tool;
  }
  return found;
}

/// The command that is most similar to a word, or to a part of whose name it is; empty if none is.
std::string nearest_command(const std::string& word) {
  Words known;
  for (const dictionary::Tool& tool : dictionary::kTools)
    if (*tool.command != '\0') known.emplace_back(tool.command);
  Words parts;  // of "scan-sim" first "scan"
  for (const std::string& command : known) parts.push_back(command.substr(0, command.find('-')));
  const std::string part = nearest_word(word, parts);
  const auto at = std::ranges::find(parts, part) - parts.begin();
  const bool is_whole = part.empty() || known[static_cast<std::size_t>(at)] == part;
  return is_whole ? nearest_word(word, known) : known[static_cast<std::size_t>(at)];
}

/// Lists the commands of a group, such as `landfall plot`, or fails as there is no such command.
int start_group(const Words& line) {
  const std::string list = cli::umbrella_help(line[0]);
  if (!list.empty() && (line.size() == 1 || line[1] == "-h" || line[1] == "--help")) {
    standard_output() << list << std::flush;
    return 0;
  }
  const std::string name = line[0] + (list.empty() ? "" : " " + line[1]);
  const std::string near = nearest_command(name);
  throw UsageError("'" + shown_word(name) + "' is not a command; " +
                   (!near.empty()   ? "did you mean " + near + "?"
                    : !list.empty() ? "landfall " + line[0] + " lists them"
                                    : "landfall help lists them"));
}

int start(const Words& line) {
  const std::string& name = line[0];
  const dictionary::Tool* const command = command_of(line);
  const Words words(line.begin() + (command == nullptr ? 1 : std::ssize(words_of(command->command))),
                    line.end());
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
  if (command == nullptr) {
    // A program that this version does not know.
    if (name[0] != '-' && fs::exists(own_folder() / ("landfall-" + name)))
      start_beside("landfall-" + name, words);
    return start_group(line);
  }
  if (*command->module != '\0') start_python(command->command, words);
  if (name == "study") return landfall_study::run(words);
  if (name == "run") return run_watched(words);
  if (std::string_view(command->name).find(' ') != std::string_view::npos) return start_group(line);
  start_beside(command->name, words);
}

int help(const Words& words) {
  if (words.empty() || words[0] == "help") {
    standard_output() << cli::umbrella_help() << std::flush;
    return 0;
  }
  Words line = words;
  line.emplace_back("--help");
  return start(line);
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* /*invocation*/) {
  try {
    if (argc < 2) throw UsageError("a command is required; landfall help lists them");
    return start(Words(argv + 1, argv + argc));
  } catch (const Error& error) {
    std::cerr << shown_text(std::string("landfall: ") + error.what()) << '\n';
    return static_cast<int>(error.exit_code());
  }
}

}  // namespace umbrella
}  // namespace landfall
