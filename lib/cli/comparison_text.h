// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall::cli {

/// The result of compare_files() as lines of text.
[[nodiscard]] std::string comparison_text(const nlohmann::ordered_json& comparison);

/// The result of describe_bin() as lines of text.
[[nodiscard]] std::string bin_text(const nlohmann::ordered_json& bin);

}  // namespace landfall::cli
