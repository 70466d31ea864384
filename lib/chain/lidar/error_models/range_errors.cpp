// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D85, D86
#include "chain/lidar/error_models/range_errors.h"

#include <algorithm>
#include <cmath>

#include "base/text/parameter_check.h"

namespace landfall {
namespace {

/// Offsets the pixel number beyond all pixels, for the second draw of a pixel and pulse.
constexpr std::int64_t kSecondDraw = std::int64_t{1} << 32U;

double draw_uniform(const RandomField& field, PulsePixel where) {
  return field.uniform(where.i(), where.j());
}

}  // namespace

RangeErrors::RangeErrors(const RangeErrorParameters& parameters, RandomSeed seed)
    : parameters_(parameters),
      seed_(seed),
      dead_(seed, RandomStream::dead_pixel),
      dropout_(seed, RandomStream::dropout),
      noise_(seed, RandomStream::range_noise),
      false_(seed, RandomStream::false_return),
      has_constant_sigma_(parameters.range_sigma_per_m == 0 && parameters.incidence_sigma_rad == 0),
      is_noisy_(parameters.range_sigma_m > 0 || !has_constant_sigma_) {
  const RangeErrorParameters& p = parameters;
  require_not_negative({"", "range_sigma_m"}, p.range_sigma_m);
  require_not_negative({"", "range_sigma_per_m"}, p.range_sigma_per_m);
  require_not_negative({"", kIncidenceNoise}, p.incidence_sigma_rad);
  require_finite({"", "range_bias_m"}, p.range_bias_m);
  require_fraction({"", "dead_pixel_frac"}, p.dead_pixel_frac);
  require_fraction({"", "dropout_frac"}, p.dropout_frac);
  require_fraction({"", "false_return_frac"}, p.false_return_frac);
  require_not_negative({"", "false_range_m/0"}, p.false_min_m);
  require(std::isfinite(p.false_max_m) && p.false_max_m > p.false_min_m, {"", "false_range_m/1"},
          p.false_max_m, "finite and greater than the gate's begin");
}

bool RangeErrors::is_dead(std::int64_t pixel) const {
  return dead_.uniform(static_cast<std::uint64_t>(pixel)) < parameters_.dead_pixel_frac;
}

void RangeErrors::find_dropouts(std::int64_t pulse, std::span<std::int8_t> is_dropped) const {
  if (parameters_.dropout_frac == 0) {  // skips the draws, none of which is less
    std::ranges::fill(is_dropped, std::int8_t{0});
    return;
  }
  const PulsePixel first{pulse, 0};
  dropout_.find_less(first.i(), first.j(), parameters_.dropout_frac, is_dropped);
}

double RangeErrors::sigma_m(double range_m, double tan_incidence) const {
  const RangeErrorParameters& p = parameters_;
  if (has_constant_sigma_) return p.range_sigma_m;
  const double with_range = p.range_sigma_per_m * range_m;
  const double with_incidence =
      p.incidence_sigma_rad == 0 ? 0 : p.incidence_sigma_rad * range_m * tan_incidence;
  return std::sqrt(p.range_sigma_m * p.range_sigma_m + with_range * with_range +
                   with_incidence * with_incidence);
}

double RangeErrors::measured_m(double range_m, PulsePixel where, double tan_incidence) const {
  const double biased = range_m + parameters_.range_bias_m;
  if (!is_noisy_) return biased;  // skips the draw, which would add zero
  return biased + sigma_m(range_m, tan_incidence) * noise_.normal(where.i(), where.j());
}

void RangeErrors::measure(std::int64_t pulse, std::span<const double> ranges_m,
                          std::span<const double> tan_incidences, std::span<double> measured_m,
                          std::int64_t number) const {
  const double bias = parameters_.range_bias_m;
  if (!is_noisy_) {
    std::ranges::transform(ranges_m, measured_m.begin(), [&](double range) { return range + bias; });
    return;
  }
  const PulsePixel first{pulse, 0, number};
  noise_.normals(first.i(), first.j(), measured_m);
  if (has_constant_sigma_) {
    const double sigma = parameters_.range_sigma_m;
    for (std::size_t i = 0; i < ranges_m.size(); ++i)
      measured_m[i] = ranges_m[i] + bias + sigma * measured_m[i];
    return;
  }
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    const double sigma = sigma_m(ranges_m[i], tan_incidences.empty() ? 0 : tan_incidences[i]);
    measured_m[i] = ranges_m[i] + bias + sigma * measured_m[i];
  }
}

std::optional<double> RangeErrors::false_return_m(PulsePixel where) const {
  const RangeErrorParameters& p = parameters_;
  if (!has_false_returns() || draw_uniform(false_, where) >= p.false_return_frac) return std::nullopt;
  const PulsePixel second{where.pulse, where.pixel + kSecondDraw};
  return p.false_min_m + draw_uniform(false_, second) * (p.false_max_m - p.false_min_m);
}

}  // namespace landfall
