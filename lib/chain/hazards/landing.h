// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "base/numerics/random_seed.h"
#include "chain/hazards/lander.h"
#include "chain/hazards/safety.h"

namespace landfall {

/// The place where the lander touches down, and the yaw of its leg 0 from +x to +y.
struct Touchdown {
  double x_m = 0, y_m = 0;
  double yaw_deg = 0;
};

/// A touchdown, judged on the true terrain.
struct Landing {
  Touchdown touchdown;
  double slope_deg = 0;    ///< NaN where a pad or the body is over no terrain
  double roughness_m = 0;  ///< NaN there
  bool is_safe = false;    ///< both within their limits
};

/// H(x, y), NaN off the terrain.
using TerrainElevation = std::function<double(double x_m, double y_m)>;

/// Judges a touchdown by the method `contact` in its one yaw: slope and roughness are the largest over the
/// planes on which the lander may stand. Elevations are those at the integer multiples of resolution_m, and
/// the lander stands at the nearest of them. Throws UsageError as LanderStencil does.
[[nodiscard]] Landing judge_landing(const Touchdown& touchdown, const Lander& lander,
                                    const HazardLimits& limits, double resolution_m,
                                    const TerrainElevation& elevation);

/// The errors of one landing.
struct LandingErrors {
  double x_m = 0, y_m = 0;        ///< from the place that the lander flies to, by its navigation
  double unit_x = 0, unit_y = 0;  ///< standard normal, of the dispersion of the touchdown
  double yaw_deg = 0;

  /// The touchdown of a lander that flies to (x, y) with a dispersion of sigma_m along each axis.
  [[nodiscard]] Touchdown touchdown(double to_x_m, double to_y_m, double sigma_m) const {
    return {to_x_m + x_m + sigma_m * unit_x, to_y_m + y_m + sigma_m * unit_y, yaw_deg};
  }
};

/// The random parts of the landing with this seed; the yaw is uniform in [0, 360) unless it is given.
[[nodiscard]] LandingErrors draw_landing(RandomSeed seed, const std::optional<double>& yaw_deg);

}  // namespace landfall
