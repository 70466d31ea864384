// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace landfall::html_report {

inline constexpr std::uint16_t kNoValueCode = 65535;
inline constexpr int kMaxSteps = 65000;
inline constexpr int kErrorSteps = 500;

/// Numbers as 16-bit codes: value = offset + code * step, within half a step (a whole step near the greatest
/// double); kNoValueCode is NaN.
struct Quantised {
  double offset = 0;
  double step = 0;
  double low = 0;  ///< the least and the greatest value before rounding; both 0 without a value
  double high = 0;
  std::vector<std::uint16_t> codes;
};

/// The least number >= `minimum` > 0 that is 1, 2 or 5 times a power of ten.
[[nodiscard]] double round_step(double minimum);

/// The step is the least of 1, 2 or 5 times a power of ten of which at most `max_steps` (1..kMaxSteps) span
/// the values. A value that is a multiple of it is kept exactly (to the rounding of double). The step is 0 if
/// there is a single value. Values that are not finite become kNoValueCode.
[[nodiscard]] Quantised quantise(std::span<const double> values, int max_steps);

/// The codes as text: differences of neighbours, with 0, -1, 1, -2, .. as 0, 1, 2, 3, ..; all low bytes, then
/// the high bytes; a zlib stream; base64. Neighbouring bins are similar, so that few bytes remain.
[[nodiscard]] std::string packed(std::span<const std::uint16_t> codes);

}  // namespace landfall::html_report
