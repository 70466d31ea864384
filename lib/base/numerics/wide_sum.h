// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace landfall {

/// The sum of the squares of errors: a signed integer of 128 bits in two words, low word first.
struct WideSum {
  std::uint64_t low = 0;
  std::int64_t high = 0;
  friend bool operator==(const WideSum&, const WideSum&) = default;
};

}  // namespace landfall
