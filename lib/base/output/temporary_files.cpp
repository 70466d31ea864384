// SPDX-License-Identifier: GPL-3.0-or-later
// The end of a run is decided once: by an interrupt, or by the first output that is about to be renamed.
// The other has no effect afterwards, so that "no output was written" is never printed when an output was
// written. SIGPIPE ends a tool without a message, like any filter; SIGQUIT requests a core dump and leaves
// the hidden file for inspection.
//
// A hidden file's name identifies its origin: `.NAME.MACHINE-PID.part`, where MACHINE is a hash of the
// host name and of the PID namespace. Containers that share a folder all have process 1, and processes of
// another machine cannot be looked up; files from another origin are neither written to nor removed.
//
// Out of memory, a tool ends immediately: a failing `new` removes the hidden files, prints a message and
// exits with 1. Unwinding would need memory itself, and some of the code it passes must not throw. HDF5
// 1.10 and GDAL crash without memory: HDF5 is initialised, opens a file and writes a chunk only if 8 MiB
// can be allocated, and GDAL is called only if 192 MiB can. If the system provides fewer threads than
// requested, a run uses those; otherwise oneTBB would fail and GDAL wait forever.
#include "base/output/temporary_files.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>
#include <string_view>

#include "base/core/error.h"

namespace landfall {
namespace {

constexpr std::array kInterrupts = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};

/// Decided once: either an interrupt ends the run, or its outputs get their names.
enum class Fate : int { open, interrupted, naming };
std::atomic<Fate> fate{Fate::open};  // NOLINT(*-avoid-non-const-global-variables)
static_assert(std::atomic<Fate>::is_always_lock_free);

/// Whether this call made the decision.
bool decide(Fate wanted) {
  Fate undecided = Fate::open;
  return fate.compare_exchange_strong(undecided, wanted);
}

// Came when outputs got their names: the next stage of the process, if there is one, ends by it.
std::atomic<int> late{0};            // NOLINT(*-avoid-non-const-global-variables)
std::atomic<bool> deferring{false};  // NOLINT(*-avoid-non-const-global-variables)
std::atomic<int> deferred{0};  // NOLINT(*-avoid-non-const-global-variables): the signal that came meanwhile
static_assert(std::atomic<int>::is_always_lock_free);

struct Slot {
  std::array<char, 4096> path{};
  std::atomic<bool> used{false};
};

// File-scope so that a signal handler, which may not allocate or lock, can read it.
std::array<Slot, 8> file_slots;  // NOLINT(*-avoid-non-const-global-variables)
std::mutex file_slots_mutex;
std::array<char, 256> farewell{};   // NOLINT(*-avoid-non-const-global-variables)
std::array<char, 256> no_memory{};  // NOLINT(*-avoid-non-const-global-variables)

/// Prepares a line for stderr; on a terminal it begins below the progress bar.
void set_line(std::array<char, 256>& line, const std::string& text) {
  const std::string whole = (::isatty(STDERR_FILENO) != 0 ? "\n" : "") + text + "\n";
  std::memcpy(line.data(), whole.c_str(), std::min(whole.size() + 1, line.size() - 1));
}

void write_stderr(std::string_view text) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

void remove_temporaries() {
  for (Slot& slot : file_slots)
    if (slot.used.load(std::memory_order_acquire)) ::unlink(slot.path.data());
}

void die_of(int signal_number) {
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

extern "C" void interrupt(int signal_number) {
  int none = 0;
  if (deferring && deferred.compare_exchange_strong(none, signal_number)) return;
  if (!decide(Fate::interrupted)) {
    late = signal_number;
    return;
  }
  remove_temporaries();
  write_stderr(farewell.data());
  die_of(signal_number);
}

/// Prints nothing, because the process that closed the pipe knows that the run has ended.
extern "C" void end_silently(int signal_number) {
  remove_temporaries();
  die_of(signal_number);
}

/// Allocates nothing and ends the process at once: any orderly exit needs memory, or runs code that must not
/// throw.
[[noreturn]] void end_without_memory() {
  static std::atomic<bool> ending{false};
  while (ending.exchange(true)) ::pause();  // another thread is already ending the process
  remove_temporaries();
  write_stderr(no_memory.data());
  ::_exit(static_cast<int>(ExitCode::data_failed));
}

std::terminate_handler abnormal_end_before = nullptr;  // NOLINT(*-avoid-non-const-global-variables)

[[noreturn]] void end_abnormally() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    end_without_memory();
  } catch (...) {  // NOLINT(bugprone-empty-catch): the previous handler reports the exception
  }
  remove_temporaries();
  if (abnormal_end_before != nullptr) abnormal_end_before();
  std::abort();
}

/// A signal that the parent chose to ignore (nohup) stays ignored.
void handle(int signal_number, void (*handler)(int)) {
  if (std::signal(signal_number, handler) == SIG_IGN) std::signal(signal_number, SIG_IGN);
}

}  // namespace

void register_temporary_file(const std::string& path) {
  const std::lock_guard lock(file_slots_mutex);
  for (Slot& slot : file_slots) {
    if (slot.used.load(std::memory_order_relaxed) || path.size() >= slot.path.size()) continue;
    std::memcpy(slot.path.data(), path.c_str(), path.size() + 1);
    slot.used.store(true, std::memory_order_release);
    return;
  }
}

void forget_temporary_file(const std::string& path) {
  const std::lock_guard lock(file_slots_mutex);
  for (Slot& slot : file_slots)
    if (slot.used.load(std::memory_order_relaxed) && path == slot.path.data())
      slot.used.store(false, std::memory_order_release);
}

void install_signal_cleanup(const std::string& program) {
  set_line(farewell, program + ": interrupted, no output was written");
  for (const int signal_number : kInterrupts) handle(signal_number, interrupt);
  handle(SIGPIPE, end_silently);
  std::signal(SIGXFSZ, SIG_IGN);
  Fate before = Fate::naming;
  fate.compare_exchange_strong(before, Fate::open);
  if (const int signal_number = late.exchange(0); signal_number != 0) interrupt(signal_number);
}

DeferredInterrupts::DeferredInterrupts() { deferring = true; }

DeferredInterrupts::~DeferredInterrupts() {
  deferring = false;
  if (requested() && std::uncaught_exceptions() == 0) interrupt(deferred);
}

bool DeferredInterrupts::requested() const noexcept { return deferred != 0; }

void install_memory_cleanup(const std::string& program) {
  set_line(no_memory, program + ": not enough memory for this run");
  std::set_new_handler(end_without_memory);
  abnormal_end_before = std::set_terminate(end_abnormally);
}

void ignore_interrupts() {
  if (deferring) return;
  if (decide(Fate::naming) || fate == Fate::naming) return;
  for (;;) ::pause();  // a handler on another thread ends the process
}

}  // namespace landfall
