// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/progress.h"

namespace landfall {

/// Compares two files of one kind as one JSON object (docs/user/landfall-info.md lists its keys): the
/// configuration keys that differ, of the files and of their upstream steps; requirements and numbers of
/// metrics, scores and verdicts side by side; for equal grids the statistics of B - A of each layer; for
/// draws with equal seeds the pairs of each requirement and of landings. Differences are B - A. Unknown
/// numbers are null. Throws FormatError as LandfallFileReader, UsageError for files of two kinds.
[[nodiscard]] nlohmann::ordered_json compare_files(const std::filesystem::path& a,
                                                   const std::filesystem::path& b,
                                                   const ProgressCallback& progress = {});

}  // namespace landfall
