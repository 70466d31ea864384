// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/raster/grid.h"

namespace landfall {

/// The filters of an "a trous" wavelet transform (Holschneider et al., 1989; Starck, Murtagh and Bertero,
/// 2015): the same filter with its taps 1, 2, 4, ... bins apart takes a map apart into details of 1, 2, 4,
/// ... bins, detail j = c_j - c_(j+1) with c_0 the map and c_(j+1) = low_pass(c_j, 2^j), and a smooth rest.
/// The map is the sum of all. Both filters are separable, and parallel by rows.

/// Reach of low_pass() in steps.
inline constexpr std::int64_t kLowPassReach = 5;
/// Reach of blur() in steps.
inline constexpr std::int64_t kBlurReach = 2;

/// Deslauriers and Dubuc's interpolating filter of 11 taps, (3, 0, -25, 0, 150, 256, 150, 0, -25, 0, 3) / 512
/// in each direction. It keeps polynomials of degree 5, so that the relief of smooth or fractal terrain
/// leaves little in the details finer than itself. Beyond the border the map is continued by point reflection
/// at its outermost bins, which keeps planes. Values are finite. T is float or double.
template <class T>
[[nodiscard]] Grid<T> low_pass(const Grid<T>& map, std::int64_t step);

/// The B3-spline filter, (1, 4, 6, 4, 1) / 16 in each direction, which preserves non-negative values. Beyond
/// the border the outermost bins repeat.
[[nodiscard]] Grid<float> blur(const Grid<float>& map, std::int64_t step);

/// The standard deviation of the details j = 0 .. scales - 1 of white noise of 1, and of the rest.
struct NoiseGains {
  std::vector<double> detail;
  double rest = 0;
};
[[nodiscard]] NoiseGains noise_gains(std::int64_t scales);

}  // namespace landfall
