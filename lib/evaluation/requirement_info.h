// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "evaluation/metrics.h"

namespace landfall {

/// What the value and the limit of a requirement count.
enum class RequirementUnit { fraction, bins, footprints };

/// A requirement of Table 1 as it is told to a reader, on a terminal and in a report.
struct RequirementInfo {
  const char* name;      ///< its key in metrics.json
  const char* measured;  ///< what has the value
  RequirementUnit unit;  ///< of value and limit
  bool at_least;         ///< the limit is the smallest value that passes, else the largest
  Requirement RequirementMetrics::*requirement;
};

/// All of them, in the order of metrics.json.
inline constexpr std::array<RequirementInfo, 6> kRequirementInfo = {
    {{"coverage", "invalid bins of the region", RequirementUnit::fraction, false,
      &RequirementMetrics::coverage},
     {"hole_size", "largest hole", RequirementUnit::bins, false, &RequirementMetrics::hole_size},
     {"hole_distance", "farthest invalid bin from a valid one", RequirementUnit::bins, false,
      &RequirementMetrics::hole_distance},
     {"relative_elevation", "footprints over the limit, z", RequirementUnit::footprints, false,
      &RequirementMetrics::relative_elevation},
     {"relative_horizontal", "footprints over the limit, x and y", RequirementUnit::footprints, false,
      &RequirementMetrics::relative_horizontal},
     {"absolute_horizontal", "footprints within the limit", RequirementUnit::fraction, true,
      &RequirementMetrics::absolute_horizontal}}};

}  // namespace landfall
