// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "evaluation/parameters.h"

namespace landfall::cli {

/// The requirements of Table 1 as lines of text: requirement, value, limit, verdict; then coverage and
/// accuracy in short. `metrics` is metrics_json(), also as read from a file: throws nlohmann::json::exception
/// where it lacks a key or has another type there.
[[nodiscard]] std::string verdict_table(const nlohmann::ordered_json& metrics,
                                        const EvaluationLimits& limits);

/// The names of the requirements that are missed or cannot be judged; throws likewise.
[[nodiscard]] std::vector<std::string> missed_requirements(const nlohmann::ordered_json& metrics);

}  // namespace landfall::cli
