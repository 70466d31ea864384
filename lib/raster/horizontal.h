// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

/// A position or a horizontal velocity in x and y of the DEM frame, metres or m/s.
struct Horizontal {
  double x = 0, y = 0;
  friend bool operator==(const Horizontal&, const Horizontal&) = default;
};

}  // namespace landfall
