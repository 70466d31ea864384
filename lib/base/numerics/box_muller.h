// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace landfall {

/// out[i] = sqrt(-2 log(1 - u[i])) cos(2 pi v[i]) (Box and Muller 1958) for u, v in [0, 1), multiples of
/// 2^-53; the three have one length. Within 2.5 ulp, in SIMD lanes by run-time dispatch. Uses only operations
/// that IEEE 754 rounds in one way, in one order, so that every processor and compiler gives the same bits.
void box_muller(std::span<const double> u, std::span<const double> v, std::span<double> out);

}  // namespace landfall
