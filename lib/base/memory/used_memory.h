// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace landfall {

/// Bytes of memory that this process has now and had at most; zeros where the system does not say.
struct UsedMemory {
  std::uint64_t now = 0;
  std::uint64_t peak = 0;
};
[[nodiscard]] UsedMemory used_memory();

}  // namespace landfall
