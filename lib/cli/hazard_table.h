// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "hazards/hazard_map.h"

namespace landfall::cli {

/// The places of the region by their safety, the sites, and the comparison with the truth, as lines of text.
[[nodiscard]] std::string hazard_table(const HazardMap& map);

/// Missed hazards, false alarms and places that are not compared.
[[nodiscard]] std::string score_lines(const HazardScore::Counts& counts, const HazardScore::Rates& rates);

/// "39.3 % safe, 60.1 % hazard, 0.6 % unknown; best site (1.2, -3.4) m, p_touchdown 0.98".
[[nodiscard]] std::string hazard_summary(const HazardMap& map);

}  // namespace landfall::cli
