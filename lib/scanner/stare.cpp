// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/stare.h"

#include "base/parameter_check.h"

namespace landfall {

Stare::Stare(const StareParameters& parameters) : Pattern(parameters.compensated), parameters_(parameters) {
  for (const double value : parameters.aim_m) require_finite({"", "aim_m"}, value);
}

std::optional<Point<DemFrame>> Stare::ground_aim(const PulseTime& /*pulse*/) const {
  return Point<DemFrame>{{parameters_.aim_m[0], parameters_.aim_m[1], 0}};
}

}  // namespace landfall
