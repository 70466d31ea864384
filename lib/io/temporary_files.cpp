// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/temporary_files.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <mutex>
#include <string_view>

namespace landfall {
namespace {

struct Slot {
  std::array<char, 4096> path{};
  std::atomic<bool> used{false};
};

// File-scope so that a signal handler, which may not allocate or lock, can read it.
std::array<Slot, 8> slots;  // NOLINT(*-avoid-non-const-global-variables)
std::mutex slots_mutex;

void write_stderr(std::string_view text) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

extern "C" void remove_temporaries_and_die(int signal_number) {
  for (Slot& slot : slots)
    if (slot.used.load(std::memory_order_acquire)) ::unlink(slot.path.data());
  write_stderr("\ninterrupted: no output was written\n");
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

void install_signal_cleanup() {
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
    // What the parent chose to ignore (nohup) stays ignored.
    if (std::signal(signal_number, remove_temporaries_and_die) == SIG_IGN)
      std::signal(signal_number, SIG_IGN);
  }
}

}  // namespace landfall
