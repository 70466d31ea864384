// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/temporary_files.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <mutex>
#include <string_view>

namespace landfall {
namespace {

constexpr std::array kInterrupts = {SIGINT, SIGTERM, SIGHUP};

struct Slot {
  std::array<char, 4096> path{};
  std::atomic<bool> used{false};
};

// File-scope so that a signal handler, which may not allocate or lock, can read it.
std::array<Slot, 8> slots;  // NOLINT(*-avoid-non-const-global-variables)
std::mutex slots_mutex;
std::array<char, 256> farewell{};  // NOLINT(*-avoid-non-const-global-variables)

void write_stderr(std::string_view text) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

extern "C" void remove_temporaries_and_die(int signal_number) {
  for (Slot& slot : slots)
    if (slot.used.load(std::memory_order_acquire)) ::unlink(slot.path.data());
  write_stderr(farewell.data());
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

}  // namespace

void register_temporary_file(const std::string& path) {
  const std::lock_guard lock(slots_mutex);
  for (Slot& slot : slots) {
    if (slot.used.load(std::memory_order_relaxed) || path.size() >= slot.path.size()) continue;
    std::memcpy(slot.path.data(), path.c_str(), path.size() + 1);
    slot.used.store(true, std::memory_order_release);
    return;
  }
}

void forget_temporary_file(const std::string& path) {
  const std::lock_guard lock(slots_mutex);
  for (Slot& slot : slots)
    if (slot.used.load(std::memory_order_relaxed) && path == slot.path.data())
      slot.used.store(false, std::memory_order_release);
}

void install_signal_cleanup(const std::string& program) {
  // On a terminal the line begins below the progress bar.
  const std::string text =
      (::isatty(STDERR_FILENO) != 0 ? "\n" : "") + program + ": interrupted, no output was written\n";
  std::memcpy(farewell.data(), text.c_str(), std::min(text.size() + 1, farewell.size() - 1));
  for (const int signal_number : kInterrupts) {
    // What the parent chose to ignore (nohup) stays ignored.
    if (std::signal(signal_number, remove_temporaries_and_die) == SIG_IGN)
      std::signal(signal_number, SIG_IGN);
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

void ignore_interrupts() {
  for (const int signal_number : kInterrupts) std::signal(signal_number, SIG_IGN);
}

}  // namespace landfall
