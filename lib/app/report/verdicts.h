// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "chain/evaluation/metrics.h"

namespace landfall::html_report {

/// The table of requirements as HTML, with the words of the terminal's table (verdict_texts()): requirement,
/// measured value, limit, verdict.
[[nodiscard]] std::string verdict_table_html(const Metrics& metrics, const EvaluationLimits& limits);

/// A paragraph with assumption_texts().
[[nodiscard]] std::string assumptions_html(const AssumptionMetrics& assumptions);

/// The same table of the user's own requirements on a hazard map; empty without any.
[[nodiscard]] std::string own_table_html(const RequirementVerdicts& own);

/// "1 of 2 custom requirements missed"; empty if none is.
[[nodiscard]] std::string own_missed_text(const RequirementVerdicts& own);

/// The verdict on all requirements, as an element of class "banner".
[[nodiscard]] std::string verdict_banner_html(const Metrics& metrics);

}  // namespace landfall::html_report
