// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "output/output_path.h"

namespace landfall {

/// The reader of a pipe has closed it: it has what it wanted. Not a failure.
class ClosedPipe : public std::runtime_error {
 public:
  ClosedPipe() : std::runtime_error("the reader closed the pipe") {}
};

/// Where the bytes of an export go, in order.
class ByteSink {
 public:
  ByteSink() = default;
  virtual ~ByteSink() = default;
  ByteSink(const ByteSink&) = delete;
  ByteSink& operator=(const ByteSink&) = delete;

  /// Throws IoError when the system refuses.
  virtual void write(std::string_view bytes) = 0;
  /// After the last byte: from here on only the output's name is wanting. finish() does it where it was not
  /// done. Throws IoError when the system refuses.
  virtual void flush() {}
  /// Throws IoError when the system refuses.
  virtual void finish() = 0;
};

/// The temporary file of an output, which finish() gives its name (output_path.h).
class FileSink final : public ByteSink {
 public:
  /// Throws IoError where the file cannot be made.
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
