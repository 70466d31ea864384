// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D1, D2
#include "raster/grid_spec.h"

#include <cmath>
#include <string>

#include "base/error.h"
#include "base/number_text.h"

namespace landfall {

GridSpec GridSpec::centered(double half_width_m, double resolution_m, const char* what) {
  const auto refuse = [&](const std::string& reason) { throw UsageError(std::string(what) + ": " + reason); };
  if (!std::isfinite(resolution_m) || resolution_m <= 0)
    refuse("resolution_m " + number_text(resolution_m) + " is not finite and positive");
  const double ratio = half_width_m / resolution_m;
  const double half = std::nearbyint(ratio);
  if (!(half >= 1 && half <= 0x1p30) || std::abs(ratio - half) > 1e-9)
    refuse("half_width_m " + number_text(half_width_m) +
           " is not a whole multiple (1 to 2^30) of resolution_m " + number_text(resolution_m));
  const auto n = static_cast<std::int64_t>(half);
  if ((2 * n + 1) * (2 * n + 1) > (std::int64_t{1} << 30U))
    refuse("half_width_m " + number_text(half_width_m) + " at resolution_m " + number_text(resolution_m) +
           " makes " + std::to_string(2 * n + 1) + " x " + std::to_string(2 * n + 1) +
           " values, more than 2^30");
  return {resolution_m, -n, -n, 2 * n + 1, 2 * n + 1};
}

}  // namespace landfall
