// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace landfall {

/// Bits of the layer `fail`: why a bin or the footprint centred on it misses a requirement.
enum FailFlag : std::int8_t {
  fail_relative_x = 1,
  fail_relative_y = 2,
  fail_relative_z = 4,
  fail_absolute_horizontal = 8,
  fail_hole_size = 16,  ///< every bin of a hole over the limit
  fail_distance = 32,
};

inline void set_flag(std::int8_t& flags, FailFlag flag) { flags = static_cast<std::int8_t>(flags | flag); }

}  // namespace landfall
