// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <iostream>
#include <utility>

namespace landfall {
namespace {

bool is_closed(int descriptor) { return ::fcntl(descriptor, F_GETFD) < 0; }

// Null: the stream of the process.
thread_local std::istream* given_input = nullptr;      // NOLINT(*-avoid-non-const-global-variables)
thread_local std::ostream* captured_output = nullptr;  // NOLINT(*-avoid-non-const-global-variables)

}  // namespace

void hold_closed_standard_streams() {
  // In ascending order, so that each stream gets its own number. Opened in the opposite direction, so that no
  // read or write succeeds.
  if (is_closed(STDIN_FILENO)) static_cast<void>(::open("/dev/null", O_WRONLY));
  if (is_closed(STDOUT_FILENO)) static_cast<void>(::open("/dev/null", O_RDONLY));
  if (is_closed(STDERR_FILENO)) static_cast<void>(::open("/dev/null", O_RDONLY));
}

std::istream& standard_input() { return given_input == nullptr ? std::cin : *given_input; }

std::ostream& standard_output() { return captured_output == nullptr ? std::cout : *captured_output; }

CapturedOutput::CapturedOutput() : before_(std::exchange(captured_output, &text_)) {}
CapturedOutput::~CapturedOutput() { captured_output = before_; }

GivenInput::GivenInput(const std::string& text) : text_(text), before_(std::exchange(given_input, &text_)) {}
GivenInput::~GivenInput() { given_input = before_; }

}  // namespace landfall
