// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace landfall {

/// How files are written. Not part of any file_id.
struct OutputOptions {
  std::filesystem::path path;
  bool overwrite = false;
  int compression = 1;  ///< deflate level 0..9
};

/// An output that appears complete under its name or not at all.
///
/// The tool writes to temporary(), a hidden file `.NAME.MACHINE-PID.part` in the same folder. commit()
/// flushes it to the disk and renames it. Until then an existing file of that name stays untouched. A run
/// that fails, or that a signal interrupts (temporary_files.h), removes the temporary file. After SIGKILL it
/// may remain; the next run for that name removes it if its process has ended. MACHINE identifies the machine
/// or container, because another machine may use the same process number: its files in a shared directory may
/// still be in use, and are not touched. If the hidden name would be too long for a file name, a hash
/// replaces NAME.
class OutputPath {
 public:
  /// Throws UsageError if `path` exists and `overwrite` is false, if it exists but is not a regular file (a
  /// directory, a pipe, a device), if its name is too long, or if its directory does not exist. A symbolic
  /// link is replaced, not followed.
  OutputPath(std::filesystem::path path, bool overwrite);
  ~OutputPath();
  OutputPath(const OutputPath&) = delete;
  OutputPath& operator=(const OutputPath&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// Flushes the temporary file, which must be closed, to the disk. A run with several outputs flushes all of
  /// them before it names the first. Throws IoError when writing fails.
  void flush();
  /// Flushes if that was not done, and gives the output its name; it gets the permissions of a file that it
  /// replaces. Throws IoError when writing fails, UsageError when another process created the output
  /// meanwhile and `overwrite` is false.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  bool overwrite_;
  bool flushed_ = false;
  bool committed_ = false;
};

/// The temporary file of this process for an output.
[[nodiscard]] std::filesystem::path temporary_of(const std::filesystem::path& output);

/// Calls a function once, just before the next output gets its name: outputs of one run are then complete
/// under the names of temporary_of(). For the whole process; objects do not nest.
class BeforeNaming {
 public:
  explicit BeforeNaming(std::function<void()> call);
  ~BeforeNaming();
  BeforeNaming(const BeforeNaming&) = delete;
  BeforeNaming& operator=(const BeforeNaming&) = delete;
};

/// The path of the hidden file `.NAME.SUFFIX` next to an output. If that would be too long for a file name, a
/// hash replaces NAME.
[[nodiscard]] std::filesystem::path hidden_beside(const std::filesystem::path& output,
                                                  const std::string& suffix);

/// Whether two paths lead to one file, which need not exist.
[[nodiscard]] bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Throws UsageError for a path that OutputPath would refuse, but does not claim the name. A tool calls it to
/// refuse an output before it reads its inputs.
void require_usable_output(const std::filesystem::path& path, bool overwrite);

/// Writes these bytes as the whole of the temporary file and flushes it; the caller commits. Throws IoError
/// when writing fails.
void write_text(OutputPath& output, const std::string& text);

}  // namespace landfall
