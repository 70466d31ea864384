// SPDX-License-Identifier: GPL-3.0-or-later
// landfall study: calls make for a parameter study, and ends with all that it started.
#include "landfall_study.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "app/cli/umbrella_page.h"
#include "base/core/error.h"
#include "base/core/standard_streams.h"
#include "base/text/shown_text.h"
#include "watched_child.h"

namespace landfall::landfall_study {
namespace {

namespace fs = std::filesystem;

constexpr int kOriginalStderr = 8;

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
                                      shared_folder("Makefile.studies").string(),
                                      "-f",
                                      "Makefile.studies",
                                      target,
                                      "STUDY=" + study,
                                      "BIN=" + own_folder().string(),
                                      "RUNS=" + (fs::current_path() / "runs").string()};
  command.insert(command.end(), words.begin() + static_cast<std::ptrdiff_t>(used), words.end());
  return command;
}

/// Whether make says in a line that a recipe was killed, which therefore has said nothing.
bool is_about_killed(const std::string& line) { return line.ends_with("] Killed"); }

/// Whether make says in a line only that a recipe failed, about which its command has said more.
bool is_echo_of_failure(const std::string& line) {
  const bool is_of_make = line.starts_with("make: ") || line.starts_with("make[");
  const bool names_recipe = line.find(": *** [") != std::string::npos && !is_about_killed(line);
  const bool is_count = line.ends_with("*** Waiting for unfinished jobs....") ||
                        line.ends_with(" not remade because of errors.");
  const bool is_lost_plan =
      line.starts_with("Makefile.studies:") && line.ends_with("study.mk: No such file or directory");
  return (is_of_make && (names_recipe || is_count)) || is_lost_plan;
}

/// Passes on the text of `messages`, less those lines; names in others are escaped. The end of the
/// other side ends it, no signal.
void pass_on_messages(int messages) {
  for (const int each : {SIGINT, SIGTERM, SIGHUP}) std::signal(each, SIG_IGN);
  std::FILE* const input = fdopen(messages, "r");
  std::string line;
  const auto pass_on = [&line] {
    const std::string text = line.ends_with('\n') ? line.substr(0, line.size() - 1) : line;
    if (!is_echo_of_failure(text) && !line.empty())
      std::cerr << shown_text(text)
                << (is_about_killed(text) ? ", as when memory runs out; the same command continues\n" : "\n");
    line.clear();
  };
  for (int c = std::fgetc(input); c != EOF; c = std::fgetc(input)) {
    line += static_cast<char>(c);
    if (c == '\n') pass_on();
  }
  pass_on();
}

/// Sends what this process writes to stderr through a child; stderr of make, which follows. Stages show their
/// progress on the original, whose descriptor STUDY_STDERR names in Makefile.studies. Returns the child; 0 if
/// there is none.
pid_t filter_messages_of_make() {
  int ends[2];
  if (pipe(ends) != 0 || dup2(STDERR_FILENO, kOriginalStderr) != kOriginalStderr) return 0;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[1]);
    close(kOriginalStderr);
    pass_on_messages(ends[0]);
    _exit(0);
  }
  if (child > 0) dup2(ends[1], STDERR_FILENO);
  close(ends[0]);
  close(ends[1]);
  setenv("STUDY_STDERR", std::to_string(kOriginalStderr).c_str(), 1);
  return std::max<pid_t>(child, 0);
}

/// The processes whose parent is this one: make, and what outlived its parent.
std::vector<pid_t> children() {
  std::ifstream list("/proc/self/task/" + std::to_string(::getpid()) + "/children");
  std::vector<pid_t> found;
  for (pid_t child = 0; list >> child;) found.push_back(child);
  return found;
}

/// Ends what outlived make, which may hold the lock of the study, and waits for the last one; `filter` ends
/// by itself then.
void end_orphans(pid_t filter) {
  for (;;) {
    for (const pid_t orphan : children())
      if (orphan != filter) ::kill(orphan, SIGTERM);
    if (const pid_t ended = ::waitpid(-1, nullptr, 0); ended < 0 && errno != EINTR) return;
  }
}

/// Starts make, which ends with this process and ends its recipes at SIGTERM only, and returns its end when
/// nothing that it started is left.
ChildEnd end_of_make(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  const pid_t filter = filter_messages_of_make();
  const auto start = [&] {
    ::execvp(argv[0], argv.data());
    std::cerr << "landfall: cannot start make: " << std::strerror(errno) << std::endl;
    return 1;
  };
  const ChildEnd end = end_of({"make", start, SIGTERM, SIGTERM});
  if (filter > 0) dup2(kOriginalStderr, STDERR_FILENO);  // the filter reads until the last writer has ended
  if (filter > 0) close(kOriginalStderr);
  end_orphans(filter);
  return end;
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

}  // namespace

int run(const std::vector<std::string>& words) {
  if (!words.empty() && (words[0] == "-h" || words[0] == "--help")) {
    standard_output() << kStudyHelp << cli::umbrella_help("study") << std::flush;
    return 0;
  }
  ChildEnd end = end_of_make(study_command(words));
  if (end.interrupted_by != 0) end.signal = end.interrupted_by;  // make itself exits with a code
  return end_as(end);
}

}  // namespace landfall::landfall_study
