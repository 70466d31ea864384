// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// The temporary files that an interrupt must remove. At most 8 at a time, names up to 4095 bytes: enough for
/// any tool, and readable from a signal handler, which may not allocate. Any further files are not removed on
/// a signal.
void register_temporary_file(const std::string& path);
void forget_temporary_file(const std::string& path);

/// On SIGINT, SIGTERM, SIGHUP and SIGXCPU: removes the registered files, reports this in one line that begins
/// with `program`, and ends by that signal. On SIGPIPE: the same without the line. A file-size limit (ulimit
/// -f) becomes a failed write, like a full disk. SIGQUIT, which requests a core dump, keeps the files for
/// debugging. Each stage of a process calls it: outputs of the stage before have their names, and an
/// interrupt that came meanwhile ends the process now.
void install_signal_cleanup(const std::string& program);

/// While one exists, the first interrupt does not end the run: requested() is true from then on, and the run
/// saves its work. The destructor ends the run by that signal, unless an exception does. A second interrupt
/// ends the run at once. Outputs may be renamed meanwhile. At most one instance exists at a time.
class DeferredInterrupts {
 public:
  DeferredInterrupts();
  ~DeferredInterrupts();
  DeferredInterrupts(const DeferredInterrupts&) = delete;
  DeferredInterrupts& operator=(const DeferredInterrupts&) = delete;

  [[nodiscard]] bool requested() const noexcept;
};

/// When `new` finds no memory: removes the registered files, reports this in one line that begins with
/// `program`, and ends with ExitCode::data_failed at once. Unwinding itself would need memory, and would pass
/// through code that must not throw.
void install_memory_cleanup(const std::string& program);

/// From now on interrupts do not end the run: call it just before an output gets its name. Does not return if
/// an interrupt came first. Without effect while interrupts are deferred.
void ignore_interrupts();

}  // namespace landfall
