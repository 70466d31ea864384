// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall::cli {

/// The result of describe_footprint() as lines of text.
[[nodiscard]] std::string footprint_text(const nlohmann::ordered_json& footprint);

}  // namespace landfall::cli
