// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

inline constexpr double kSpeedOfLight_mps = 299792458;

/// The range that light travels to and back in this time.
[[nodiscard]] constexpr double range_of_time_m(double time_s) { return kSpeedOfLight_mps / 2 * time_s; }

}  // namespace landfall
