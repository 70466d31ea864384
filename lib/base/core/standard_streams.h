// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <iosfwd>
#include <sstream>
#include <string>

namespace landfall {

/// Reopens standard streams that the parent closed (`2>&-`); call it before any file is opened. The system
/// assigns the lowest free number, so an output could get the number of standard error, and messages would be
/// written into it. Reading and writing these streams fails as it does on closed ones.
void hold_closed_standard_streams();

/// std::cin, or the text that a GivenInput of this thread has.
[[nodiscard]] std::istream& standard_input();
/// std::cout, or the text that a CapturedOutput of this thread collects.
[[nodiscard]] std::ostream& standard_output();

/// During its life, standard_output() of this thread is a text.
class CapturedOutput {
 public:
  CapturedOutput();
  ~CapturedOutput();
  CapturedOutput(const CapturedOutput&) = delete;
  CapturedOutput& operator=(const CapturedOutput&) = delete;
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::ostream* before_;
};

/// During its life, standard_input() of this thread gives this text.
class GivenInput {
 public:
  explicit GivenInput(const std::string& text);
  ~GivenInput();
  GivenInput(const GivenInput&) = delete;
  GivenInput& operator=(const GivenInput&) = delete;

 private:
  std::istringstream text_;
  std::istream* before_;
};

}  // namespace landfall
