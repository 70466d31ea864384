// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D293
#pragma once

#include <array>
#include <cstdint>

#include "hazards/safety.h"
#include "picture/color_map.h"

namespace landfall {

/// How a value of `safe` or `outcome` is drawn.
template <class Value>
struct PlaceClass {
  Value value;
  const char* name;
  std::uint32_t color;
};

/// From the worst to the best for a lander that touches down there: what is drawn of several places has the
/// first class of them (D293).
inline constexpr std::array<PlaceClass<Safety>, 3> kSafetyClasses = {
    {{Safety::hazard, "hazard", kHazardColor},
     {Safety::unknown, "unknown", kUnknownColor},
     {Safety::safe, "safe", kSafeColor}}};
inline constexpr std::array<PlaceClass<HazardOutcome>, 5> kOutcomeClasses = {
    {{HazardOutcome::missed_hazard, "missed hazard", kMarkColor},
     {HazardOutcome::hazard_found, "hazard found", kHazardColor},
     {HazardOutcome::false_alarm, "false alarm", kFalseAlarmColor},
     {HazardOutcome::unknown, "unknown", kUnknownColor},
     {HazardOutcome::safe_found, "safe found", kSafeColor}}};

}  // namespace landfall
