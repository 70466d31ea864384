// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "base/output/output_path.h"

namespace landfall {

/// The reader of a pipe closed it because it needs no more data. This is not a failure.
class ClosedPipe : public std::runtime_error {
 public:
  ClosedPipe() : std::runtime_error("the reader closed the pipe") {}
};

/// Receives the bytes of an export in order.
class ByteSink {
 public:
  ByteSink() = default;
  virtual ~ByteSink() = default;
  ByteSink(const ByteSink&) = delete;
  ByteSink& operator=(const ByteSink&) = delete;

  /// Throws IoError when the system refuses.
  virtual void write(std::string_view bytes) = 0;
  /// Call after the last byte: the data is then complete, and only the output's final name is missing.
  /// finish() calls it if that was not done. Throws IoError when the system refuses.
  virtual void flush() {}
  /// Throws IoError when the system refuses.
  virtual void finish() = 0;
};

/// The temporary file of an output; finish() gives it the output's name (output_path.h).
class FileSink final : public ByteSink {
 public:
  /// Throws IoError if the file cannot be created.
  explicit FileSink(OutputPath& output);
  ~FileSink() override;
  void write(std::string_view bytes) override;
  void flush() override;
  void finish() override;

 private:
  [[noreturn]] void fail(const char* what) const;

  OutputPath& output_;
  int descriptor_;
};

/// Standard output. A closed pipe throws ClosedPipe; SIGPIPE is ignored from its construction on.
class StandardOutputSink final : public ByteSink {
 public:
  StandardOutputSink();
  void write(std::string_view bytes) override;
  void finish() override {}
};

}  // namespace landfall
