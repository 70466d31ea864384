// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall::cli {

/// The result of describe_file() as aligned lines of text, at most about 100 columns wide. `whole_config`
/// prints the whole configuration as JSON, not only the values that differ from their defaults. Throws
/// FormatError if metrics or plan of the file are incomplete.
[[nodiscard]] std::string description_text(const nlohmann::ordered_json& description, bool whole_config);

}  // namespace landfall::cli
