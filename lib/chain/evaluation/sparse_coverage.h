// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "chain/evaluation/coverage.h"

namespace landfall {

/// Coverage without its layers.
struct JudgedCoverage {
  CoverageMetrics metrics;
  std::vector<Hole> holes;  ///< including their distances
};

/// The metrics and holes of assess_coverage() and the flags of flag_coverage(), without the layers. Fast
/// where invalid bins are few and near a valid one: each is labelled and measured by itself; others take
/// assess_coverage().
[[nodiscard]] JudgedCoverage judge_coverage(const BinMask& valid, const BinMask& region,
                                            const EvaluationLimits& limits, Grid<std::int8_t>& fail);

}  // namespace landfall
