// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D350
#include "chain/lidar/receiver/range_timer.h"

#include <cassert>
#include <cmath>
#include <utility>

#include "base/numerics/light.h"
#include "base/returns/pulse_pixel.h"
#include "base/text/parameter_check.h"

namespace landfall {

RangeTimer::RangeTimer(RangeTimerParameters parameters, std::size_t pixels, RandomSeed seed)
    : parameters_(std::move(parameters)), jitter_(seed, RandomStream::timing_jitter) {
  RangeTimerParameters& p = parameters_;
  require_not_negative({"", "jitter_sigma_s"}, p.jitter_sigma_s);
  require_not_negative({"", "pixel_offset_sigma_m"}, p.pixel_offset_sigma_m);
  require(std::abs(p.clock_scale_ppm) <= 1e5, {"", "clock_scale_ppm"}, p.clock_scale_ppm, "in [-1e5, 1e5]");
  require_not_negative({"", "timer_step_s"}, p.timer_step_s);
  assert(p.pixel_offset_m.empty() || (p.pixel_offset_sigma_m == 0 && p.pixel_offset_m.size() == pixels));
  if (p.pixel_offset_sigma_m > 0) {
    p.pixel_offset_m.resize(pixels);
    RandomField(seed, RandomStream::pixel_offset).normals_along_i(0, 0, p.pixel_offset_m);
    for (double& offset_m : p.pixel_offset_m) offset_m *= p.pixel_offset_sigma_m;
  }
  is_on_ = p.jitter_sigma_s > 0 || !p.pixel_offset_m.empty() || p.clock_scale_ppm != 0 || p.timer_step_s > 0;
}

void RangeTimer::apply(std::int64_t pulse, std::int64_t number, std::span<double> ranges_m) const {
  if (!is_on_) return;
  const RangeTimerParameters& p = parameters_;
  const double scale = 1 + 1e-6 * p.clock_scale_ppm;
  const double step_m = range_of_time_m(p.timer_step_s);
  if (p.jitter_sigma_s > 0) {
    const PulsePixel first{pulse, 0, number};
    std::vector<double> draws(ranges_m.size());
    jitter_.normals(first.i(), first.j(), draws);
    const double sigma_m = range_of_time_m(p.jitter_sigma_s);
    for (std::size_t i = 0; i < ranges_m.size(); ++i) ranges_m[i] += sigma_m * draws[i];
  }
  assert(p.pixel_offset_m.empty() || p.pixel_offset_m.size() == ranges_m.size());
  for (std::size_t i = 0; i < p.pixel_offset_m.size(); ++i) ranges_m[i] += p.pixel_offset_m[i];
  for (double& range_m : ranges_m) {
    range_m *= scale;
    if (step_m > 0) range_m = step_m * std::floor(range_m / step_m + 0.5);
  }
}

}  // namespace landfall
