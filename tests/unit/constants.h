// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>

#include "base/numerics/non_finite.h"

namespace landfall {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;

}  // namespace landfall
