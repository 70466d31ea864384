// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "hdf5/h5.h"

namespace landfall::h5 {

/// Flushes and closes a file that was written; why that failed, nothing where all is on its way to the disk.
/// Asks also whether any dataset that create_dataset() or write_text() made in this process could not be
/// closed: HDF5 writes what is small or in its caches only then, and a Handle that goes out of scope cannot
/// say that it failed.
[[nodiscard]] std::optional<std::string> close_file(Handle& file);

}  // namespace landfall::h5
