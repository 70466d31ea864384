// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D450
#include "chain/evaluation/parameters.h"

#include <limits>

#include "base/core/error.h"
#include "base/core/fields.h"
#include "base/dictionary/layers.h"
#include "base/text/number_text.h"
#include "base/text/parameter_check.h"

namespace landfall {
void check(const EvaluationParameters& parameters) {
  require_positive({"", "region_radius_m"}, parameters.region_radius_m);
  require_positive({"region", "half_width_m"}, parameters.region_half_width_m);
  require_positive({"", "footprint_m"}, parameters.footprint_m);
  require_fraction({"", "quantile"}, parameters.quantile);
  FieldWalk walk{[](const std::string& key, const auto& limit) {
    const double value = requirement::number_of(limit).value_or(0);
    key.ends_with("_frac") ? require_fraction({"limits", key}, value)
                           : require_not_negative({"limits", key}, value);
  }};
  EvaluationLimits::fields(walk, parameters.limits);
}

std::optional<double> limit_of_key(const EvaluationLimits& limits, std::string_view key) {
  return number_at(limits, key);
}

std::optional<double> limit_of_layer(const EvaluationLimits& limits, std::string_view layer) {
  const dictionary::Layer* const words = dictionary::find_layer("evaluation", layer);
  return words != nullptr ? limit_of_key(limits, words->limit) : std::nullopt;
}

Footprint footprint_of(const EvaluationParameters& parameters, double resolution_m) {
  const double half = parameters.footprint_m / (2 * resolution_m) + 1e-9;
  require(half >= 0 && half < 0x1p20 + 1, {"", "footprint_m"}, parameters.footprint_m,
          "between 0 and 2^21 bins of the DEM");
  return parameters.footprint_shape == FootprintShape::square
             ? Footprint::square(static_cast<std::int64_t>(half))
             : Footprint::disc(static_cast<std::int64_t>(half * half));
}

std::string square_text(std::int64_t edge_bins) {
  return std::to_string(edge_bins) + " x " + std::to_string(edge_bins);
}

double coarsest_judged_posting_m(const EvaluationParameters& parameters) {
  return parameters.footprint_m / static_cast<double>(kMinFootprintBins - 1);
}

std::optional<std::string> why_not_judged(const EvaluationParameters& parameters, double resolution_m) {
  const std::int64_t bins = footprint_of(parameters, resolution_m).edge_bins();
  if (judges_relative_errors(bins)) return std::nullopt;
  return "a footprint of " + number_text(parameters.footprint_m) + " m has " + square_text(bins) +
         " bins of " + number_text(resolution_m) + " m, and relative errors are judged from " +
         square_text(kMinFootprintBins) + " bins on; the coarsest posting that can be judged is " +
         number_text(coarsest_judged_posting_m(parameters)) + " m";
}

EvaluationLimits effective_limits(const EvaluationParameters& parameters, const Footprint& footprint) {
  EvaluationLimits limits = parameters.limits;
  if (judges_relative_errors(footprint.edge_bins())) return limits;
  limits.relative_z_m = limits.relative_xy_m = std::numeric_limits<double>::infinity();
  return limits;
}

BinMask judged_region(const EvaluationParameters& parameters, const GridSpec& dem, const BinMask* mask) {
  if (parameters.region_shape == RegionShape::circle)
    return circular_region(dem, parameters.region_radius_m, parameters.region_center_m);
  if (parameters.region_shape == RegionShape::square)
    return square_region(dem, parameters.region_half_width_m);
  if (mask == nullptr || mask->spec() != dem)
    throw FormatError("region/path: its grid differs from that of z_est");
  if (count_set(*mask) == 0) throw FormatError("region/path: no bin of the mask is set");
  return *mask;
}

}  // namespace landfall
