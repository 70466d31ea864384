// SPDX-License-Identifier: GPL-3.0-or-later
// Flips one random bit of each metadata byte of a small valid file of every kind, one at a time, and lets
// every reader of that kind read the damaged file. Metadata are all bytes that are not chunks of a dataset.
//   hdf5_bits [--sealed] [--every N] [--first I] [--seed N] [--kind NAME] [--keep FOLDER]
//   hdf5_bits --check N [--seed N] [--kind NAME] [--keep FOLDER]
// With --sealed the files are as landfall writes them, and every reader must refuse each damaged one.
// With --check each such file is edited N times anywhere: flipped bits, overwritten bytes, a part copied over
// another, a shorter or longer file. The check of landfall-info --check must refuse all but edits of chunks,
// whose own checksums show them, and those that leave the bytes before the seal as they are.
// A finding is a signal, an exception that is not landfall::Error, more than 10 s of processor time or more
// than 500 MB. Each one is printed with its place, and the exit code is 1; --keep saves its file. Readers run
// in a process of their own, which is replaced after a finding.
#include <hdf5.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "fuzz_target.h"
#include "hdf5_readers.h"
#include "landfall_files.h"
#include "memory_file.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/h5.h"

namespace landfall::fuzz {
namespace {

constexpr time_t kLongest_s = 10;
constexpr rlim_t kMaxMemory_bytes = 500'000'000;

struct Options {
  bool sealed = false;
  std::size_t check = 0;  ///< edits of each file; 0: flipped bits
  std::size_t every = 1;
  std::size_t first = 0;
  std::uint64_t seed = 1;
  std::string kind;  ///< empty: all
  std::string keep;  ///< empty: findings are not kept
};

/// The progress of a reading process, in memory that it shares with its parent.
struct Progress {
  std::size_t next = 0;  ///< index of the place
  std::size_t refusals = 0;
  std::size_t reader = 0;
  std::array<char, 200> text{};  ///< what a foreign exception says
};

/// Marks the bytes of chunks.
struct ChunkMarks {
  std::vector<bool>& marks;
};

herr_t mark_chunks(hid_t root, const char* name, const H5O_info_t* info, void* data) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  std::vector<bool>& marks = static_cast<ChunkMarks*>(data)->marks;
  const h5::Handle dataset(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose);
  const h5::Handle properties(H5Dget_create_plist(dataset.get()), H5Pclose);
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose);
  hsize_t count = 0;
  if (H5Pget_layout(properties.get()) != H5D_CHUNKED ||
      H5Dget_num_chunks(dataset.get(), space.get(), &count) < 0)
    return 0;
  for (hsize_t i = 0; i < count; ++i) {
    haddr_t address = 0;
    hsize_t size = 0;
    std::array<hsize_t, H5S_MAX_RANK> offset{};
    unsigned mask = 0;
    H5Dget_chunk_info(dataset.get(), space.get(), i, offset.data(), &mask, &address, &size);
    std::fill_n(marks.begin() + static_cast<std::ptrdiff_t>(address), size, true);
  }
  return 0;
}

/// The offsets of all metadata bytes.
std::vector<std::size_t> metadata_of(const MemoryFile& file) {
  std::vector<bool> marks(std::filesystem::file_size(file.path()));
  const h5::Handle opened(H5Fopen(file.path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  ChunkMarks chunks{marks};
  H5Ovisit2(opened.get(), H5_INDEX_NAME, H5_ITER_INC, mark_chunks, &chunks, H5O_INFO_BASIC);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < marks.size(); ++i)
    if (!marks[i]) places.push_back(i);
  return places;
}

/// The place where the seal of a file begins (lib/store/hdf5/guard/file_seal.cpp).
std::size_t seal_begin(const std::vector<std::byte>& bytes) {
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data() + bytes.size() - 56, sizeof(size));
  return size;
}

/// A copy with one edit. Parts have at most 64 bytes, so that none covers a whole seal.
std::vector<std::byte> edited(std::vector<std::byte> bytes, std::mt19937_64& draw) {
  const auto below = [&](std::size_t end) { return static_cast<std::size_t>(draw() % end); };
  const std::size_t part = 1 + below(64);
  const std::size_t at = below(bytes.size() - part);
  switch (below(6)) {
    case 0:
      bytes.resize(below(bytes.size()));
      break;
    case 1:
      bytes.resize(bytes.size() + part, static_cast<std::byte>(below(256)));
      break;
    case 2:
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size() - part)), part,
                  bytes.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 3:
      for (std::size_t i = 0; i < part; ++i) bytes[at + i] = static_cast<std::byte>(below(256));
      break;
    default:
      for (std::size_t i = 0; i < 1 + part / 16; ++i)
        bytes[below(bytes.size())] ^= std::byte{1} << static_cast<unsigned>(below(8));
  }
  return bytes;
}

class DrawSeries {
 public:
  DrawSeries(const LandfallFile& original, const Options& options)
      : kind_(original.kind),
        bytes_(options.sealed || options.check > 0 ? original.sealed : original.bytes),
        options_(options),
        readers_(options.check > 0 ? std::vector<Hdf5Reader>{check_file} : readers_of(original.kind)) {
    file_.fill(bytes_);
    const std::vector<std::size_t> all = metadata_of(file_);
    if (options.check > 0) metadata_ = all;
    for (std::size_t i = 0; i < options.check; ++i) places_.push_back(i);
    for (std::size_t i = options.first; options.check == 0 && i < all.size(); i += options.every)
      places_.push_back(all[i]);
    void* const shared =
        ::mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) throw std::bad_alloc();
    progress_ = new (shared) Progress;
  }

  /// The number of findings.
  std::size_t run() {
    std::size_t findings = 0;
    while (progress_->next < places_.size()) {
      const pid_t reader = ::fork();
      if (reader < 0) throw std::runtime_error("no process");
      if (reader == 0) read_all();
      int status = 0;
      ::waitpid(reader, &status, 0);
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
      ++findings;
      print_finding(status);
      restore();
      ++progress_->next;
    }
    std::cout << kind_ << ": " << places_.size() << (options_.check > 0 ? " edits, " : " bits, ")
              << readers_.size() << " readers, " << progress_->refusals << " of "
              << places_.size() * readers_.size() << " refused, " << findings << " findings" << std::endl;
    return findings;
  }

 private:
  [[nodiscard]] std::size_t place() const { return places_[progress_->next]; }

  [[nodiscard]] unsigned bit() const {
    return static_cast<unsigned>(8 * RandomField(options_.seed, RandomStream::dropout).uniform(place()));
  }

  /// Ends this process, and its file.
  [[noreturn]] void leave(int code) const {
    if (options_.check > 0) ::unlink(file_.path().c_str());
    ::_exit(code);
  }

  [[noreturn]] void read_all() {
    const rlimit limit{kMaxMemory_bytes, kMaxMemory_bytes};
    ::setrlimit(RLIMIT_DATA, &limit);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    try {
      for (; progress_->next < places_.size(); ++progress_->next) read_one();
    } catch (const std::exception& error) {
      std::strncpy(progress_->text.data(), error.what(), progress_->text.size() - 1);
      leave(1);
    }
    leave(0);
  }

  /// Whether an accepted file has other contents than the chunks show.
  [[nodiscard]] bool is_changed(const std::vector<std::byte>& bytes) const {
    const std::size_t end = seal_begin(bytes_);
    return bytes.size() < end || std::ranges::any_of(metadata_, [&](std::size_t place) {
             return place < end && bytes[place] != bytes_[place];
           });
  }

  void check_one() {
    std::mt19937_64 draw(options_.seed << 32U | progress_->next);
    const std::vector<std::byte> bytes = edited(bytes_, draw);
    file_.fill(bytes);  // a new file, of this process
    limit_time();
    if (!accepts("", [&] { readers_[0](file_.path()); }))
      ++progress_->refusals;
    else if (is_changed(bytes))
      throw BrokenPromise("the damage was not noticed");
  }

  void read_one() {
    if (options_.check > 0) return check_one();
    file_.put(place(), bytes_[place()] ^ std::byte{1} << bit());
    for (progress_->reader = 0; progress_->reader < readers_.size(); ++progress_->reader) {
      limit_time();
      const bool accepted = accepts("", [&] { readers_[progress_->reader](file_.path()); });
      if (accepted && options_.sealed) throw BrokenPromise("the damage was not noticed");
      if (!accepted) ++progress_->refusals;
    }
    restore();
  }

  /// SIGPROF ends the process after so much processor time, which does not depend on what else runs.
  static void limit_time() {
    itimerval timer{};
    timer.it_value.tv_sec = kLongest_s;
    ::setitimer(ITIMER_PROF, &timer, nullptr);
  }

  void restore() {
    if (options_.check == 0) file_.put(place(), bytes_[place()]);
  }

  void print_finding(int status) {
    std::cout << "finding: " << kind_ << ", ";
    if (options_.check > 0)
      std::cout << "edit " << place() << ": ";
    else
      std::cout << "bit " << bit() << " of byte " << place() << ", reader " << progress_->reader << ": ";
    if (WIFSIGNALED(status))
      std::cout << (WTERMSIG(status) == SIGPROF ? "more than 10 s" : ::strsignal(WTERMSIG(status)));
    else
      std::cout << progress_->text.data();
    std::cout << std::endl;
    if (options_.keep.empty()) return;
    if (options_.check > 0) {
      std::mt19937_64 draw(options_.seed << 32U | progress_->next);
      file_.fill(edited(bytes_, draw));
    }
    std::filesystem::copy_file(
        file_.path(), std::filesystem::path(options_.keep) / (kind_ + "-" + std::to_string(place()) + ".h5"),
        std::filesystem::copy_options::overwrite_existing);
  }

  std::string kind_;
  const std::vector<std::byte>& bytes_;
  const Options& options_;
  std::vector<Hdf5Reader> readers_;
  MemoryFile file_;
  std::vector<std::size_t> metadata_;  ///< of a file that is checked
  std::vector<std::size_t> places_;    ///< bytes, or numbers of edits
  Progress* progress_ = nullptr;
};

Options options_of(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name == "--sealed") {
      options.sealed = true;
      continue;
    }
    if (i + 1 == argc) throw std::invalid_argument("no value of " + std::string(name));
    if (name == "--check") options.check = std::stoull(argv[i + 1]);
    if (name == "--every") options.every = std::stoull(argv[i + 1]);
    if (name == "--first") options.first = std::stoull(argv[i + 1]);
    if (name == "--seed") options.seed = std::stoull(argv[i + 1]);
    if (name == "--kind") options.kind = argv[i + 1];
    if (name == "--keep") options.keep = argv[i + 1];
    ++i;
  }
  return options;
}

}  // namespace
}  // namespace landfall::fuzz

int main(int argc, char** argv) {
  using namespace landfall;
  const ThreadLimit one_thread(1);
  const fuzz::Options options = fuzz::options_of(argc, argv);
  std::size_t findings = 0;
  for (const fuzz::LandfallFile& file : fuzz::landfall_files())
    if ((options.kind.empty() || options.kind == file.kind) &&
        !((options.sealed || options.check > 0) && file.kind == "table"))
      findings += fuzz::DrawSeries(file, options).run();
  return findings == 0 ? 0 : 1;
}
