// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall::cli {

/// plan_json() as lines of text: where the time goes, and what is covered.
[[nodiscard]] std::string plan_table(const nlohmann::ordered_json& plan);

}  // namespace landfall::cli
