// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "files/plan_file.h"

namespace landfall::cli {

/// A plan as lines of text: where the time goes, and what is covered.
[[nodiscard]] std::string plan_table(const PlanMetrics& plan);

}  // namespace landfall::cli
