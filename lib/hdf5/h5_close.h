// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "hdf5/h5.h"

namespace landfall::h5 {

/// Flushes and closes a file that was written. Returns the reason for a failure, or nothing if all data is on
/// its way to the disk. Also reports a dataset made by create_dataset() or write_text() in this process that
/// could not be closed: HDF5 writes small or cached data only on closing, and a Handle that goes out of scope
/// cannot report a failure.
[[nodiscard]] std::optional<std::string> close_file(Handle& file);

}  // namespace landfall::h5
