// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <iostream>
#include <sstream>
#include <string>

namespace landfall::cli {

/// Reopens standard streams that the parent closed (`2>&-`); call it before any file is opened. The system
/// assigns the lowest free number, so an output could get the number of standard error, and messages would be
/// written into it. Reading and writing these streams fails as it does on closed ones.
void hold_closed_standard_streams();

/// Collects the standard output during its life.
class CapturedOutput {
 public:
  CapturedOutput() : before_(std::cout.rdbuf(text_.rdbuf())) {}
  ~CapturedOutput() { std::cout.rdbuf(before_); }
  CapturedOutput(const CapturedOutput&) = delete;
  CapturedOutput& operator=(const CapturedOutput&) = delete;
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::streambuf* before_;
};

}  // namespace landfall::cli
