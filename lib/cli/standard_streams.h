// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall::cli {

/// Reopens standard streams that the parent closed (`2>&-`); call it before any file is opened. The system
/// assigns the lowest free number, so an output could get the number of standard error, and messages would be
/// written into it. Reading and writing these streams fails as it does on closed ones.
void hold_closed_standard_streams();

}  // namespace landfall::cli
