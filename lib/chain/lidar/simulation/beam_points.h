// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "base/geometry/frames.h"
#include "chain/lidar/scanner/scanner.h"

namespace landfall {

/// The columns of points, metres.
struct PointsOut {
  double *x, *y, *z;
};

/// out[k] = T (b + r_k n) with the beam's exit b and direction n (Eq. 1), the same bits as Transform * Point,
/// in SIMD lanes by run-time dispatch. The ranges: as many for each beam, one after the other; a NaN range
/// gives a NaN point.
void beam_points(const Transform<DemFrame, LidarFrame>& T_dem_lidar, std::span<const Beam> beams,
                 std::span<const double> ranges_m, const PointsOut& out);

/// Bit `row`: Transform * Point adds the three products of this row from the left, (x + y) + z, otherwise x +
/// (y + z). It depends on the processor and the compiler. Empty where it adds them in yet another way.
[[nodiscard]] std::optional<std::int64_t> rows_added_from_left();

}  // namespace landfall
