// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D155
#include "app/report/quantised.h"

#include <algorithm>
#include <cmath>

#include "app/report/escape.h"
#include "store/hdf5/chunk_codec.h"

namespace landfall::html_report {
namespace {

/// The largest power of ten up to a positive number, rounded once.
double power_of_ten_in(double number) {
  double power = 1;
  if (number >= 1) {
    while (10 * power <= number) power *= 10;
    return power;
  }
  while (number * power < 1 && power < 1e308) power *= 10;
  return 1 / power;
}

void find_extremes(std::span<const double> values, Quantised& result) {
  bool any = false;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    result.low = any ? std::min(result.low, value) : value;
    result.high = any ? std::max(result.high, value) : value;
    any = true;
  }
}

std::uint16_t zigzag(std::uint16_t code, std::uint16_t before) {
  const auto difference = static_cast<std::int16_t>(static_cast<std::uint16_t>(code - before));
  return static_cast<std::uint16_t>(difference < 0 ? -2 * difference - 1 : 2 * difference);
}

}  // namespace

double round_step(double minimum) {
  const double power = power_of_ten_in(minimum);
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= minimum) return digit * power;
  return 10 * power;
}

Quantised quantise(std::span<const double> values, int max_steps) {
  Quantised result;
  find_extremes(values, result);
  result.offset = result.low;
  // Computed from halves, because the whole range may exceed the largest double.
  const double range = 2 * (result.high / (2 * max_steps) - result.low / (2 * max_steps));
  double first = 0;
  if (range >= 1e-290) {
    result.step = round_step(range);
    first = std::floor(result.low / result.step);
    if (std::isinf(first * result.step)) ++first;
    result.offset = first * result.step;
  }
  const auto code = [&](double value) {
    if (!std::isfinite(value)) return kNoValueCode;
    if (result.step == 0) return std::uint16_t{0};
    return static_cast<std::uint16_t>(std::clamp(std::round(value / result.step) - first, 0.0, 65534.0));
  };
  result.codes.resize(values.size());
  std::ranges::transform(values, result.codes.begin(), code);
  return result;
}

std::string packed(std::span<const std::uint16_t> codes) {
  // A higher level than 6 saves almost nothing.
  constexpr int kLevel = 6;
  std::vector<std::uint16_t> differences(codes.size());
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    differences[i] = zigzag(codes[i], before);
    before = codes[i];
  }
  ChunkEncoder encoder(sizeof(std::uint16_t), kLevel);
  return base64(encoder.encode(std::as_bytes(std::span(differences))));
}

}  // namespace landfall::html_report
