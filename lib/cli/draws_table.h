// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall::cli {

/// How many draws passed each requirement, as lines of text: share, Wilson's interval and the exact lower
/// bound. `verdict` is verdict_json().
[[nodiscard]] std::string draws_table(const nlohmann::ordered_json& verdict);

/// "297 of 299 draws pass all requirements, ...".
[[nodiscard]] std::string draws_summary(const nlohmann::ordered_json& verdict);

}  // namespace landfall::cli
