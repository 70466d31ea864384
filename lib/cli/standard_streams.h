// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall::cli {

/// Occupies standard streams that the parent closed (`2>&-`), before any file is opened: the system gives the
/// lowest free number, and an output that got the number of standard error would take the messages into its
/// midst. Reading and writing these streams fails as it does on closed ones.
void hold_closed_standard_streams();

}  // namespace landfall::cli
