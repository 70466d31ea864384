// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

namespace landfall::cli {
namespace {

bool is_closed(int descriptor) { return ::fcntl(descriptor, F_GETFD) < 0; }

}  // namespace

void hold_closed_standard_streams() {
  // In ascending order, so that each stream gets its own number. Opened in the opposite direction, so that no
  // read or write succeeds.
  if (is_closed(STDIN_FILENO)) static_cast<void>(::open("/dev/null", O_WRONLY));
  if (is_closed(STDOUT_FILENO)) static_cast<void>(::open("/dev/null", O_RDONLY));
  if (is_closed(STDERR_FILENO)) static_cast<void>(::open("/dev/null", O_RDONLY));
}

}  // namespace landfall::cli
