// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

/// As std::log and std::exp, with the same bits on every machine (base/numerics/elementary-inl.h).

/// `x` positive and normal; below 1 ulp.
[[nodiscard]] double natural_log(double x);
/// `x` <= 709; relative error below 1e-14; 0 for x < -700.
[[nodiscard]] double exponential(double x);

}  // namespace landfall
