// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "evaluation/metrics.h"

namespace landfall {

/// A requirement as a person reads it: counts with their denominator and share, lengths beside their limit.
struct VerdictText {
  const char* name;     ///< as in metrics.json
  std::string value;    ///< "87,348 of 785,321, 11.1 %, worst 5.79 cm"; empty if there is none
  std::string limit;    ///< "5 cm", ">= 95 %"
  const char* verdict;  ///< "pass", "FAIL" or "not judged"
};

/// One per requirement, in the order of kRequirementInfo.
[[nodiscard]] std::array<VerdictText, kRequirementInfo.size()> verdict_texts(const Metrics& metrics,
                                                                             const EvaluationLimits& limits);

/// "FAIL" if a requirement is missed, else "not judged" if one is not judged (no truth), else "pass".
[[nodiscard]] const char* overall_verdict(const RequirementMetrics& requirements);

}  // namespace landfall
