// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace landfall {

/// A part of a command in a process of its own, whose end this process sees: one that is killed, as when
/// memory runs out, says nothing itself.
struct WatchedChild {
  std::string name;           ///< for messages
  std::function<int()> body;  ///< returns the exit code
  int signal_at_our_end;      ///< sent to the child when this process ends
  int signal_at_interrupts;   ///< sent at SIGINT, SIGTERM and SIGHUP; 0: the same, unless a terminal sent it
                              ///< to both
};

/// How a child ended.
struct ChildEnd {
  int exit_code = 0;
  int signal = 0;          ///< that ended the child; 0: none
  int interrupted_by = 0;  ///< the signal that this process got meanwhile; 0: none
};

/// Runs the body in a child and waits for it. Throws IoError if no process can be started.
[[nodiscard]] ChildEnd end_of(const WatchedChild& child);

/// Ends this process as the child ended; returns its exit code where no signal ended it.
int end_as(const ChildEnd& end);

}  // namespace landfall
