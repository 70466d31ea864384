// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace landfall {

/// A pulse: its number, counted from 0, and its time since the first one.
struct PulseTime {
  std::int64_t pulse = 0;
  double since_start_s = 0;
};

}  // namespace landfall
