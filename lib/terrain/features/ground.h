// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

/// A place relative to a feature's centre, metres, axes of frame D.
struct Offset {
  double x_m = 0;
  double y_m = 0;
};

/// What a feature finds: the elevation so far at a place, and that of the summed base under its own centre.
/// Metres.
struct Ground {
  double here_m = 0;
  double at_centre_m = 0;
};

/// The rule of features that stand on the ground: the higher of the two wins. A hole (NaN) stays a hole.
inline double standing(const Ground& ground, double height_m) {
  const double top_m = ground.at_centre_m + height_m;
  return ground.here_m < top_m ? top_m : ground.here_m;
}

}  // namespace landfall
