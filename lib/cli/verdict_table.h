// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "evaluation/metrics.h"

namespace landfall::cli {

/// The requirements of Table 1 and the user's own as lines of text: requirement, value, limit, verdict; then
/// a summary of coverage and accuracy.
[[nodiscard]] std::string verdict_table(const Metrics& metrics, const EvaluationLimits& limits);

/// The names of the requirements that are missed or cannot be judged, separated by ", ".
[[nodiscard]] std::string missed_requirements(const Metrics& metrics);
[[nodiscard]] std::string missed_requirements(const OwnVerdicts& own);

/// The user's own requirements on another result, as in verdict_table(); empty without any.
[[nodiscard]] std::string own_table(const OwnVerdicts& own);

}  // namespace landfall::cli
