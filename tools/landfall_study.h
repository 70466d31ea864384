// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace landfall {

/// The folder of this program.
std::filesystem::path own_folder();

/// The folder of landfall's data that has this file: in the installation, or in the repository in which this
/// program was built. Throws IoError if no folder has it.
std::filesystem::path shared_folder(const std::filesystem::path& file);

namespace landfall_study {  // `landfall study`, which calls make
/// Returns the exit code of make; ends by the signal that ended it or this process.
int run(const std::vector<std::string>& words);
}  // namespace landfall_study

}  // namespace landfall
