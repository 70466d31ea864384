// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "chain/evaluation/metrics.h"

namespace landfall {

/// A requirement as a person reads it: counts with their denominator and share, lengths next to their limit.
struct VerdictText {
  std::string name;     ///< as in metrics.json
  std::string value;    ///< "87,348 of 785,321, 11.1 %, worst 5.79 cm"; empty if there is none
  std::string limit;    ///< "5 cm", ">= 95 %"
  const char* verdict;  ///< "pass", "FAIL" or "not judged"
};

/// One per requirement, in the order of the dictionary; then the user's own.
[[nodiscard]] std::vector<VerdictText> verdict_texts(const Metrics& metrics, const EvaluationLimits& limits);

/// The user's own requirements: "statistics.z.le90_m 1.23 cm".
[[nodiscard]] std::vector<VerdictText> own_texts(const RequirementVerdicts& verdicts);

/// "footprint of 35 x 35 bins", "truth nodes every 0.05 m", "3 returns per bin (median)", "4.2 % of the bins
/// with a single return": those that are known.
[[nodiscard]] std::vector<std::string> assumption_texts(const AssumptionMetrics& assumptions);

/// The reason why requirements are not judged: "the DEM has no truth", ...
[[nodiscard]] std::string missing_text(const Metrics& metrics);

/// "FAIL" if a requirement is missed, else "not judged" if one is not judged (no truth), else "pass".
[[nodiscard]] const char* overall_verdict(const Metrics& metrics);

}  // namespace landfall
