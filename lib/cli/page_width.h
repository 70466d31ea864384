// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>

namespace landfall::cli {

/// The columns of the terminal on standard output, between 60 and 120; 80 where it is not a terminal.
[[nodiscard]] inline std::size_t page_width() {
  winsize size{};
  if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return 80;
  return std::clamp<std::size_t>(size.ws_col, 60, 120);
}

}  // namespace landfall::cli
