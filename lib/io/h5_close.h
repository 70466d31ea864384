// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall::h5 {

/// Why a dataset that create_dataset() or write_text() made could not be closed, empty where all could: HDF5
/// writes what is small or in its caches only then, and a Handle that goes out of scope cannot say that it
/// failed. The first failure in this process; to be asked before a file counts as complete.
[[nodiscard]] std::string first_close_failure();

}  // namespace landfall::h5
