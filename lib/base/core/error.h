// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace landfall {

/// Exit codes of all tools (docs/user/cli.md).
enum class ExitCode : int {
  done = 0,
  data_failed = 1,         ///< an input's content is wrong, or reading or writing failed
  usage = 2,               ///< bad flag, bad config, or the output exists
  requirement_missed = 3,  ///< what --require-pass or --require-safe asks for is missed or cannot be judged
};

/// The base of all errors that a user can cause or fix. The message names file, key, value, bound and what
/// to do. `parameter` is the one whose value would resolve the error, as the throwing module names it:
/// "half_width_m", a string literal; the tool adds the option that sets it to the message.
class Error : public std::runtime_error {
 public:
  [[nodiscard]] ExitCode exit_code() const noexcept { return exit_code_; }
  [[nodiscard]] const char* parameter() const noexcept { return parameter_; }

 protected:
  Error(ExitCode code, const std::string& message, const char* parameter = "")
      : std::runtime_error(message), exit_code_(code), parameter_(parameter) {}

 private:
  ExitCode exit_code_;
  const char* parameter_;
};

/// A flag or a config value is wrong, or the request contradicts itself: exit 2.
class UsageError : public Error {
 public:
  explicit UsageError(const std::string& message, const char* parameter = "")
      : Error(ExitCode::usage, message, parameter) {}
};

/// The content of a data file is not valid, or the data cannot be processed: exit 1.
class FormatError : public Error {
 public:
  explicit FormatError(const std::string& message, const char* parameter = "")
      : Error(ExitCode::data_failed, message, parameter) {}
};

/// The system refused to read or write: exit 1.
class IoError : public Error {
 public:
  explicit IoError(const std::string& message) : Error(ExitCode::data_failed, message) {}
};

}  // namespace landfall
