// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <compare>
#include <cstdint>

namespace landfall {

/// One measurement: the pulse, counted from 0, the pixel's row-major position on the detector, and the number
/// of the return, counted from 0.
struct PulsePixel {
  std::int64_t pulse = 0;
  std::int64_t pixel = 0;
  std::int64_t number = 0;

  /// In the order of pulse, pixel, number.
  friend auto operator<=>(const PulsePixel&, const PulsePixel&) = default;

  /// Indices of the measurement's draws in a RandomField: i, j. The first returns of a pulse's pixels have
  /// consecutive j.
  [[nodiscard]] std::uint64_t i() const { return static_cast<std::uint64_t>(pulse); }
  [[nodiscard]] std::uint64_t j() const {
    return static_cast<std::uint64_t>(pixel) + (static_cast<std::uint64_t>(number) << 40U);
  }
};

}  // namespace landfall
