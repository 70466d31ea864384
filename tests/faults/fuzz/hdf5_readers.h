// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace landfall::fuzz {

/// Reads a file as one of the tools does. Throws landfall::Error if it refuses the file.
using Hdf5Reader = void (*)(const std::filesystem::path&);

/// The readers for files of this kind (landfall_files.h).
[[nodiscard]] std::vector<Hdf5Reader> readers_of(const std::string& kind);

}  // namespace landfall::fuzz
