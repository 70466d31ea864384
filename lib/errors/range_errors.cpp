// SPDX-License-Identifier: GPL-3.0-or-later
#include "errors/range_errors.h"

#include <cmath>
#include <sstream>

#include "base/error.h"

namespace landfall {
namespace {

void require(bool good, const char* key, double value, const char* bound) {
  if (good) return;
  std::ostringstream message;
  message.precision(17);
  message << "noise: " << key << ": " << value << " is not " << bound;
  throw UsageError(message.str());
}

bool is_fraction(double value) { return value >= 0 && value <= 1; }

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
  require(std::isfinite(p.range_sigma_m) && p.range_sigma_m >= 0, "range_sigma_m", p.range_sigma_m,
          "finite and >= 0");
  require(std::isfinite(p.range_bias_m), "range_bias_m", p.range_bias_m, "finite");
  require(is_fraction(p.dead_pixel_frac), "dead_pixel_frac", p.dead_pixel_frac, "in [0, 1]");
  require(is_fraction(p.dropout_frac), "dropout_frac", p.dropout_frac, "in [0, 1]");
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

}  // namespace landfall
