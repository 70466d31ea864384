// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "chain/evaluation/metrics.h"
#include "chain/hazards/hazard_map.h"

namespace landfall::cli {

/// The requirements of Table 1 and the user's own as lines of text: requirement, value, limit, verdict; then
/// a summary of coverage and accuracy.
[[nodiscard]] std::string verdict_table(const Metrics& metrics, const EvaluationLimits& limits);

/// The names of the requirements that are missed or cannot be judged, separated by ", ".
[[nodiscard]] std::string missed_requirements(const Metrics& metrics);
[[nodiscard]] std::string missed_requirements(const RequirementVerdicts& own);

/// The user's own requirements on another result, as in verdict_table(); empty without any.
[[nodiscard]] std::string own_table(const RequirementVerdicts& own);

/// The places of the region by their safety, the sites, and the comparison with the truth, as lines of text.
[[nodiscard]] std::string hazard_table(const HazardMap& map);

/// Missed hazards, false alarms and places that are not compared.
[[nodiscard]] std::string score_lines(const HazardScore::Counts& counts, const HazardScore::Rates& rates);

/// "39.3 % safe, 60.1 % hazard, 0.6 % unknown; best site (1.2, -3.4) m, p_touchdown 0.98".
[[nodiscard]] std::string hazard_summary(const HazardMap& map);

/// How many draws passed each requirement, as lines of text: share, Wilson's interval and the exact lower
/// bound. `verdict` is verdict_json().
[[nodiscard]] std::string draws_table(const nlohmann::ordered_json& verdict);

/// "297 of 299 draws pass all requirements, ...".
[[nodiscard]] std::string draws_summary(const nlohmann::ordered_json& verdict);

}  // namespace landfall::cli
