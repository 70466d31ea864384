// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "files/plan_file.h"

namespace landfall::cli {

/// A plan as lines of text: use of time and coverage.
[[nodiscard]] std::string plan_table(const PlanMetrics& plan);

}  // namespace landfall::cli
