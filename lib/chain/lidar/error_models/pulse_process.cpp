// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D325
#include "chain/lidar/error_models/pulse_process.h"

#include <cmath>

#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

constexpr double kIndependentExponent = 40;

}  // namespace

PulseProcess::PulseProcess(double share) {
  const int maximum = static_cast<int>(middle_.size());
  while (levels_ < maximum && std::ldexp(share, levels_) <= kIndependentExponent) ++levels_;
  const double block = std::ldexp(share, levels_);
  across_ = {portable::exp(-block), std::sqrt(-portable::expm1(-2 * block))};
  for (int n = 0; n < levels_; ++n) {
    const double half = std::ldexp(share, n);
    middle_[static_cast<std::size_t>(n)] = {0.5 / portable::cosh(half), std::sqrt(portable::tanh(half))};
  }
}

double PulseProcess::at(std::int64_t pulse, const RandomField& field, std::uint64_t axis) const {
  const auto draw = [&](std::int64_t i) { return field.normal(static_cast<std::uint64_t>(i), axis); };
  std::int64_t first = (pulse >> levels_) << levels_;
  double x_first = draw(first);
  if (pulse == first) return x_first;
  double x_last = across_.kept * x_first + across_.renewed * draw(first + (std::int64_t{1} << levels_));
  for (int n = levels_ - 1; n >= 0; --n) {
    const std::int64_t middle = first + (std::int64_t{1} << n);
    const Step& step = middle_[static_cast<std::size_t>(n)];
    const double x_middle = step.kept * (x_first + x_last) + step.renewed * draw(middle);
    if (pulse == middle) return x_middle;
    (pulse < middle ? x_last : x_first) = x_middle;
    if (pulse > middle) first = middle;
  }
  return x_first;
}

}  // namespace landfall
