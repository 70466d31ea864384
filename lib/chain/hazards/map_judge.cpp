// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/map_judge.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/core/error.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr double kLengthTolerance = 1e-9;  // bins, and metres

struct Width {
  const char* key;
  const char* what;
  double bins;  ///< from the place to the outermost bin that enters
};

/// The part of the lander or of the windows that reaches furthest.
Width widest(const HazardParameters& parameters, double resolution_m) {
  const auto bins = [&](double radius_m) { return std::floor((radius_m + kLengthTolerance) / resolution_m); };
  const Lander& lander = parameters.lander;
  const Width body = {"lander/body_radius_m", "a lander", bins(lander.body_radius_m)};
  if (parameters.method == HazardMethod::contact) {
    const Width legs = {"lander/leg_radius_m", "a lander",
                        std::floor(lander.leg_radius_m / resolution_m + 0.5 + kLengthTolerance) +
                            bins(lander.pad_diameter_m / 2)};
    return legs.bins > body.bins ? legs : body;
  }
  if (parameters.method != HazardMethod::range_difference) return body;
  const double rock = bins(parameters.limits.roughness_m);
  return {rock > body.bins ? "limits/roughness_m" : body.key, "a window", body.bins + rock + 1};
}

/// The bins that the map must hold to each side of a place. A stencil of more bins would take any amount of
/// memory, so that this is checked first.
std::int64_t checked_reach(const HazardParameters& parameters, const GridSpec& spec) {
  const Width width = widest(parameters, spec.resolution_m);
  if (2 * width.bins + 1 <= static_cast<double>(std::min(spec.rows, spec.cols)))
    return static_cast<std::int64_t>(width.bins);
  throw UsageError(std::string(width.key) + ": " + width.what + " of " + short_number(2 * width.bins + 1) +
                   " bins across is larger than the map of " + std::to_string(spec.cols) + " x " +
                   std::to_string(spec.rows) + " bins of " + number_text(spec.resolution_m) + " m");
}

}  // namespace

// Methods other than contact need bins on both sides of the centre. Of 5 samples the plane through any three
// would have a median of 0.
Lander lander_for(const HazardParameters& parameters, double resolution_m) {
  Lander lander = parameters.lander;
  if (parameters.method == HazardMethod::contact) return lander;
  const bool is_lmeds = parameters.method == HazardMethod::lmeds;
  const char* const remark = is_lmeds ? "and the method is lmeds"
                             : parameters.method == HazardMethod::plane
                                 ? "and the method is plane"
                                 : "and the method is range_difference";
  require_bins({"lander/body_radius_m", lander.body_radius_m, is_lmeds ? 2 : 1, remark}, resolution_m);
  lander.leg_radius_m = std::max(lander.leg_radius_m, 2 * resolution_m);
  return lander;
}

MapJudge::MapJudge(const HazardParameters& parameters, const GridSpec& map)
    : parameters_(parameters),
      reach_bins_(checked_reach(parameters, map)),
      lander_(lander_for(parameters, map.resolution_m), map.resolution_m) {
  if (parameters.method != HazardMethod::range_difference) return;
  windows_ = {lander_.body.half_bins(), rock_half_bins(parameters.limits.roughness_m, map.resolution_m)};
  require_bins({"limits/roughness_m", parameters.limits.roughness_m, 1,
                "and rocks of this height have no window of range_difference"},
               map.resolution_m);
}

PlaceMeasures MapJudge::measure(const Grid<double>& z, const BinMask& places,
                                const ProgressCallback& progress) const {
  switch (parameters_.method) {
    case HazardMethod::contact:
      return measure_contact(z, lander_, places, progress);
    case HazardMethod::plane:
      return measure_plane(z, lander_, places, progress);
    case HazardMethod::range_difference:
      return measure_range_difference(z, windows_, places, progress);
    case HazardMethod::lmeds:
      return measure_lmeds(z, lander_, places, progress);
  }
  throw std::logic_error("unknown hazard method");
}

double MapJudge::slope_base_m() const {
  const auto half_bins = static_cast<double>(lander_.body.half_bins());
  switch (parameters_.method) {
    case HazardMethod::contact:
      return parameters_.lander.leg_radius_m;
    case HazardMethod::plane:
      return std::sqrt(static_cast<double>(lander_.body.squared_offsets())) * lander_.resolution_m;
    case HazardMethod::range_difference:
      return 2 * half_bins * lander_.resolution_m;
    case HazardMethod::lmeds:
      return half_bins * lander_.resolution_m;
  }
  throw std::logic_error("unknown hazard method");
}

BinMask region_of(const GridSpec& map, const std::optional<BinMask>& mask,
                  const HazardParameters& parameters) {
  if (has_mask(parameters.region_shape)) return mask.value();
  return clipped_circle(map, parameters.region_radius_m, parameters.region_center_m);
}

std::int64_t known_places(const Grid<double>& z, const BinMask& region) {
  std::int64_t known = 0;
  for (std::size_t i = 0; i < z.spec().size(); ++i)
    if (region.values()[i] != 0 && std::isfinite(z.values()[i])) ++known;
  return known;
}

std::string unknown_reason(const BinMask& region, std::int64_t known, const HazardParameters& parameters) {
  const std::string where = " " + region_text(parameters);
  if (count_set(region) == 0) return "nothing to judge: no bin of the map lies" + where;
  if (known == 0) return "nothing to judge: no bin" + where + " has an elevation";
  return "nothing to judge: at each place" + where +
         " a part of the lander lies on a bin without an elevation or beyond the map's border; scan more, or "
         "fill larger holes (hole_fill_bins)";
}

}  // namespace landfall
