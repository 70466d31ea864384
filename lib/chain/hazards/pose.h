// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "base/raster/grid.h"
#include "chain/hazards/lander.h"

namespace landfall {

/// A lander that stands at a place: its plane, its pads, and the bin that decides its roughness.
struct LanderPose {
  struct Pad {
    BinIndex bin;    ///< of its centre, on the map
    double z_m = 0;  ///< height of the ground under it
    bool touches =
        true;  ///< false: the fourth pad of a lander that stands on three; it hangs above its ground
  };

  double yaw_rad = 0;     ///< of leg 0, from +x to +y
  std::vector<Pad> pads;  ///< of the legs in order; none for a fitted plane
  double east = 0;        ///< gradient of the plane, metres per metre
  double north = 0;
  double centre_z_m = 0;  ///< height of the plane at the place
  double slope_deg = 0;
  BinIndex highest;        ///< the bin under the body that is farthest above the plane, or off a fitted plane
  double roughness_m = 0;  ///< distance of that bin from the plane
};

/// The poses that give a place its slope and its roughness; of equal poses the first yaw and plane.
struct WorstPoses {
  LanderPose steepest;
  LanderPose roughest;
};

/// The poses behind measure_contact(), by plain loops over yaws, planes and bins: slope and roughness equal
/// its within 1e-9. None where measure_contact() gives NaN. `lander` has the resolution of `z`.
[[nodiscard]] std::optional<WorstPoses> worst_contact_poses(const Grid<double>& z,
                                                            const LanderStencil& lander, BinIndex place);

/// The least-squares plane behind measure_plane(), which has no pads; both poses are equal. None where
/// measure_plane() gives NaN.
[[nodiscard]] std::optional<WorstPoses> least_squares_poses(const Grid<double>& z,
                                                            const LanderStencil& lander, BinIndex place);

}  // namespace landfall
