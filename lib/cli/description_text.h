// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall::cli {

/// describe_file() as aligned lines of text, at most about 100 columns wide. `whole_config`: the
/// configuration as JSON, not only what differs from its defaults. Throws FormatError where metrics or plan
/// of the file lack what they should hold.
[[nodiscard]] std::string description_text(const nlohmann::ordered_json& description, bool whole_config);

}  // namespace landfall::cli
