// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// The temporary files that SIGINT and SIGTERM must remove. At most 8 at a time, names up to 4095 bytes:
/// enough for any tool, and readable from a signal handler, which may not allocate. More are simply not
/// removed on a signal.
void register_temporary_file(const std::string& path);
void forget_temporary_file(const std::string& path);

/// On SIGINT, SIGTERM and SIGHUP: removes the registered files, says so in one line begun by `program`, ends
/// by that signal. A file-size limit (ulimit -f) becomes a failed write, as a full disk is.
void install_signal_cleanup(const std::string& program);

/// From now on the run ends whole: for the moment when an output is about to get its name.
void ignore_interrupts();

}  // namespace landfall
