// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a fuzz target without libFuzzer, with any compiler: on the files and folders that are named, then on
// mutations of them (mutation.h), always the same ones for the same seed.
//   fuzz_X [--words DICTIONARY] PATH...
//   LANDFALL_FUZZ_RUNS  mutations, 2000 by default
//   LANDFALL_FUZZ_SEED  their seed, 1 by default
// An input that is a finding (a foreign exception, a signal, more than 30 s or 512 MiB) is written to
// finding-TARGET in the working folder, and the exit code is 1.
//
// Fuzz targets run in every build, libFuzzer in one. A second build of the libraries, with clang and
// sanitizers, takes longer than all tests; the tests therefore run each target on its corpus and on 2,000
// mutations of it, which depend only on a seed. Long runs are made by hand.
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "fuzz_target.h"
#include "mutation.h"

namespace landfall::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kLongest_s = 30;

/// The present input, for a signal's handler.
std::string_view running;
std::array<char, 256> finding_name = {};

void save_running() {
  const int file = ::open(finding_name.data(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
  if (file < 0 || ::write(file, running.data(), running.size()) < 0) return;
  ::close(file);
}

void on_signal(int number) {
  save_running();
  const char* const text = number == SIGALRM ? "finding: more than 30 s\n" : "finding: a signal\n";
  static_cast<void>(!::write(STDERR_FILENO, text, std::strlen(text)));
  ::_exit(1);
}

void install(const std::string& target) {
  const std::string name = "finding-" + target;
  std::copy_n(name.begin(), std::min(name.size(), finding_name.size() - 1), finding_name.begin());
  for (const int number : {SIGALRM, SIGSEGV, SIGBUS, SIGFPE, SIGABRT}) std::signal(number, on_signal);
#if !defined(LANDFALL_SANITIZED)  // a sanitizer reserves far more than it uses
  constexpr rlim_t kMaxMemory_bytes = rlim_t{512} << 20U;
  const rlimit limit{kMaxMemory_bytes, kMaxMemory_bytes};
  ::setrlimit(RLIMIT_DATA, &limit);
#endif
}

std::string read_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(stream), {}};
}

void add_inputs(const fs::path& path, std::vector<std::string>& inputs) {
  std::vector<fs::path> files;
  if (!fs::is_directory(path))
    files.push_back(path);
  else
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) inputs.push_back(read_file(file));
}

/// False for a finding.
bool run(const std::string& input) {
  running = input;
  ::alarm(kLongest_s);
  try {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
  } catch (const std::exception& error) {
    save_running();
    std::cerr << "finding: " << error.what() << "\nthe input is in " << finding_name.data() << '\n';
    return false;
  }
  ::alarm(0);
  return true;
}

std::uint64_t setting(const char* name, std::uint64_t otherwise) {
  const char* const given = std::getenv(name);
  return given == nullptr ? otherwise : std::stoull(given);
}

int run_all(const std::vector<std::string>& inputs, const std::vector<std::string>& words) {
  const std::uint64_t runs = setting("LANDFALL_FUZZ_RUNS", 2000);
  const std::uint64_t seed = setting("LANDFALL_FUZZ_SEED", 1);
  std::cout << inputs.size() << " inputs, " << runs << " mutations, LANDFALL_FUZZ_SEED=" << seed << '\n';
  for (const std::string& input : inputs)
    if (!run(input)) return 1;
  Mutator mutator(inputs, words, seed);
  for (std::uint64_t i = 0; i < runs; ++i)
    if (!run(mutator.next())) return 1;
  return 0;
}

}  // namespace
}  // namespace landfall::fuzz

int main(int argc, char** argv) {
  using namespace landfall::fuzz;
  install(fs::path(argv[0]).filename().string());
  std::vector<std::string> inputs;
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const bool is_dictionary = std::string_view(argv[i]) == "--words" && i + 1 < argc;
    if (is_dictionary)
      words = read_dictionary(argv[++i]);
    else
      add_inputs(argv[i], inputs);
  }
  if (inputs.empty()) {
    std::cerr << "no input\n";
    return 2;
  }
  return run_all(inputs, words);
}
