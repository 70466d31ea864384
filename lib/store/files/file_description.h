// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/core/progress.h"

namespace landfall {

struct DescriptionOptions {
  bool statistics = true;  ///< false: no value of a layer or column is read
};

/// Describes a landfall file of any kind as one JSON object (docs/user/landfall-info.md lists its keys): kind
/// and origin; extent; the layers and columns with their statistics; the parts specific to the kind (scan,
/// mesh, features, metrics, plan); configuration, inputs and upstream steps. Unknown numbers are null. Throws
/// FormatError, naming the file, unless it is a regular file that LandfallFileReader reads.
[[nodiscard]] nlohmann::ordered_json describe_file(const std::filesystem::path& path,
                                                   const DescriptionOptions& options,
                                                   const ProgressCallback& progress = {});

}  // namespace landfall
