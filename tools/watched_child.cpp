// SPDX-License-Identifier: GPL-3.0-or-later
#include "watched_child.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "base/core/error.h"

namespace landfall {
namespace {

constexpr int kPassedOn[] = {SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t child_process = 0;  // NOLINT(*-avoid-non-const-global-variables): of a handler
volatile std::sig_atomic_t signal_at_interrupts = 0;  // NOLINT(*-avoid-non-const-global-variables)
volatile std::sig_atomic_t interrupted_by = 0;        // NOLINT(*-avoid-non-const-global-variables)

extern "C" void pass_on(int number, siginfo_t* from, void* /*context*/) {
  interrupted_by = number;
  const bool has_child_got_it = signal_at_interrupts == 0 && from->si_code == SI_KERNEL;
  if (child_process > 0 && !has_child_got_it)
    ::kill(static_cast<pid_t>(child_process), signal_at_interrupts != 0 ? signal_at_interrupts : number);
}

/// A signal that the parent chose to ignore (nohup) stays ignored.
void pass_on_interrupts() {
  for (const int each : kPassedOn) {
    struct sigaction before {};
    ::sigaction(each, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_sigaction = pass_on;
    action.sa_flags = SA_SIGINFO;
    ::sigaction(each, &action, nullptr);
  }
}

sigset_t interrupts() {
  sigset_t set;
  ::sigemptyset(&set);
  for (const int each : kPassedOn) ::sigaddset(&set, each);
  return set;
}

}  // namespace

ChildEnd end_of(const WatchedChild& child) {
  const sigset_t held = interrupts();
  sigset_t before;
  ::sigprocmask(SIG_BLOCK, &held, &before);
  const pid_t self = ::getpid();
  const pid_t process = ::fork();
  if (process == 0) {
    ::sigprocmask(SIG_SETMASK, &before, nullptr);
    ::prctl(PR_SET_PDEATHSIG, child.signal_at_our_end);
    if (::getppid() != self) ::_exit(1);
    std::exit(child.body());
  }
  if (process > 0) {
    child_process = process;
    signal_at_interrupts = child.signal_at_interrupts;
    pass_on_interrupts();
  }
  ::sigprocmask(SIG_SETMASK, &before, nullptr);
  if (process < 0) throw IoError("cannot start " + child.name + ": " + std::strerror(errno));
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  child_process = 0;
  const int interrupt = static_cast<int>(interrupted_by);
  if (WIFSIGNALED(status)) return {0, WTERMSIG(status), interrupt};
  return {WEXITSTATUS(status), 0, interrupt};
}

int end_as(const ChildEnd& end) {
  if (end.signal != 0) {
    std::signal(end.signal, SIG_DFL);
    std::raise(end.signal);
  }
  return end.exit_code;
}

}  // namespace landfall
