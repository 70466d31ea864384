// SPDX-License-Identifier: GPL-3.0-or-later
// A DEM takes at most 2^31 - 1 returns within its grid, so that the int32 count of a bin cannot overflow;
// a plan, which is easily made finer, is refused if the count of a bin does.
#include "chain/gridding/accumulator.h"

#include <cmath>
#include <string>

#include "base/core/error.h"
#include "base/numerics/non_finite.h"

namespace landfall {
namespace {

const GridSpec& checked_grid(const GridSpec& spec) {
  if (!std::isfinite(spec.resolution_m) || spec.resolution_m <= 0)
    throw UsageError("grid: resolution_m " + std::to_string(spec.resolution_m) +
                     " is not finite and positive");
  if (spec.rows < 1 || spec.cols < 1)
    throw UsageError("grid: " + std::to_string(spec.rows) + " x " + std::to_string(spec.cols) +
                     " bins; at least 1 x 1 are needed");
  return spec;
}

}  // namespace

BinValues empty_bin() { return {0, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan}; }

Accumulator::Accumulator(const GridSpec& spec) : spec_(checked_grid(spec)) {}

}  // namespace landfall
