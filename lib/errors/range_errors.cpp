// SPDX-License-Identifier: GPL-3.0-or-later
#include "errors/range_errors.h"

#include <algorithm>

#include "base/parameter_check.h"

namespace landfall {
namespace {

double draw_uniform(const RandomField& field, PulsePixel where) {
  return field.uniform(static_cast<std::uint64_t>(where.pulse), static_cast<std::uint64_t>(where.pixel));
}

}  // namespace

RangeErrors::RangeErrors(const RangeErrorParameters& parameters, std::uint64_t seed)
    : parameters_(parameters),
      dead_(seed, RandomStream::dead_pixel),
      dropout_(seed, RandomStream::dropout),
      noise_(seed, RandomStream::range_noise) {
  const RangeErrorParameters& p = parameters;
  require_not_negative({"noise", "range_sigma_m"}, p.range_sigma_m);
  require_finite({"noise", "range_bias_m"}, p.range_bias_m);
  require_fraction({"noise", "dead_pixel_frac"}, p.dead_pixel_frac);
  require_fraction({"noise", "dropout_frac"}, p.dropout_frac);
}

bool RangeErrors::is_dead(std::int64_t pixel) const {
  return dead_.uniform(static_cast<std::uint64_t>(pixel)) < parameters_.dead_pixel_frac;
}

bool RangeErrors::is_dropped(PulsePixel where) const {
  return parameters_.dropout_frac > 0 && draw_uniform(dropout_, where) < parameters_.dropout_frac;
}

double RangeErrors::measured_m(double range_m, PulsePixel where) const {
  const double biased = range_m + parameters_.range_bias_m;
  if (parameters_.range_sigma_m == 0) return biased;  // spares the draw, which would add zero
  return biased + parameters_.range_sigma_m * noise_.normal(static_cast<std::uint64_t>(where.pulse),
                                                            static_cast<std::uint64_t>(where.pixel));
}

void RangeErrors::measure(std::int64_t pulse, std::span<const double> ranges_m,
                          std::span<double> measured_m) const {
  const double sigma = parameters_.range_sigma_m;
  const double bias = parameters_.range_bias_m;
  if (sigma == 0) {
    std::ranges::transform(ranges_m, measured_m.begin(), [&](double range) { return range + bias; });
    return;
  }
  noise_.normals(static_cast<std::uint64_t>(pulse), 0, measured_m);
  for (std::size_t i = 0; i < ranges_m.size(); ++i)
    measured_m[i] = ranges_m[i] + bias + sigma * measured_m[i];
}

}  // namespace landfall
