// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>

namespace landfall {

/// The folder of real rasters, which is not part of the repository and may be missing: LANDFALL_DATA, or the
/// folder beside the repository, whose path CMake sets.
inline std::filesystem::path shared_data() {
  const char* const given = std::getenv("LANDFALL_DATA");
  return given == nullptr ? LANDFALL_SHARED_DATA : given;
}

}  // namespace landfall
