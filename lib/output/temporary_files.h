// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// The temporary files that an interrupt must remove. At most 8 at a time, names up to 4095 bytes:
/// enough for any tool, and readable from a signal handler, which may not allocate. More are simply not
/// removed on a signal.
void register_temporary_file(const std::string& path);
void forget_temporary_file(const std::string& path);

/// On SIGINT, SIGTERM, SIGHUP and SIGXCPU: removes the registered files, says so in one line begun by
/// `program`, ends by that signal. On SIGPIPE the same without the line. A file-size limit (ulimit -f)
/// becomes a failed write, as a full disk is. SIGQUIT, which asks for a core, keeps the files for
/// debugging.
void install_signal_cleanup(const std::string& program);

/// Where `new` finds no memory: removes the registered files, says so in one line begun by `program`, ends
/// with ExitCode::data_failed at once. Unwinding would need memory itself, and some of what it passes must
/// not throw.
void install_memory_cleanup(const std::string& program);

/// From now on the run ends whole: for the moment when an output is about to get its name. Does not return
/// where an interrupt came first.
void ignore_interrupts();

}  // namespace landfall
