// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "chain/lidar/receiver/echo.h"

namespace landfall {

/// The point of the waveform whose time a receiver reports.
enum class TimingPoint {
  leading_edge,       ///< the first crossing of a fixed level
  constant_fraction,  ///< the first crossing of a fixed fraction of the maximum
  peak,               ///< the maximum
  centroid,           ///< the mean
};

struct EchoTiming {
  TimingPoint point = TimingPoint::peak;
  double sigma_m = 0;       ///< c/2 times the pulse's standard deviation, > 0
  double threshold_pe = 0;  ///< of leading_edge, photoelectrons of an echo that is not stretched, > 0
  double fraction = 0;      ///< of constant_fraction, in (0, 1)
};

/// Reduces each echo to the numbers that a receiver needs; `echoes` has the size of `rays`. The crossings and
/// the maximum are found within 1e-9 sigma_m. An echo whose sub-rays span up to one sigma has a single
/// maximum, found by Newton's method in SIMD lanes; a longer one is searched in steps of sigma/16, which pass
/// over a crossing by less than 0.05 % of the level. The bits depend neither on the instruction set nor on
/// the other echoes.
void time_echoes(const EchoRays& rays, const EchoTiming& timing, std::span<Echo> echoes);

}  // namespace landfall
