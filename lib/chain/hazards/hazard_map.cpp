// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D282
#include "chain/hazards/hazard_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/core/error.h"
#include "base/text/number_text.h"
#include "chain/hazards/map_judge.h"
#include "chain/hazards/safe_probability.h"

namespace landfall {
namespace {

/// The probability of each place that a touchdown counts: p_safe, without it 1 if the place is safe; 0 of
/// unknown places.
Grid<float> counted_probability(const HazardMap& map) {
  auto p = Grid<float>::unset(map.safe.spec());
  for (std::size_t i = 0; i < p.spec().size(); ++i) {
    const auto safety = static_cast<Safety>(map.safe.values()[i]);
    p.values()[i] = safety == Safety::unknown ? 0.0F
                    : map.p_safe              ? map.p_safe->values()[i]
                    : safety == Safety::safe  ? 1.0F
                                              : 0.0F;
  }
  return p;
}

/// Leaves a sigma to measured bins only, and gives those without one z_sigma_m, if given.
void complete_sigma(HazardInput& input, const Grid<std::int8_t>& is_measured,
                    std::optional<double> z_sigma_m) {
  std::int64_t known = 0;
  for (std::size_t i = 0; i < input.z.spec().size(); ++i) {
    double& sigma = input.z_sigma->values()[i];
    if (is_measured.values()[i] == 0) {
      sigma = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    if (std::isnan(sigma) && z_sigma_m) {
      sigma = *z_sigma_m;
      if (input.noise_sigma) input.noise_sigma->values()[i] = *z_sigma_m;
    }
    ++(std::isnan(sigma) ? input.bins_without_sigma : known);
  }
  if (known == 0) input.z_sigma.reset();
}

BinMask measured_bins(const Grid<double>& z) {
  BinMask measured(z.spec());
  std::ranges::transform(z.values(), measured.values().begin(),
                         [](double value) { return static_cast<std::int8_t>(std::isnan(value) ? 0 : 1); });
  return measured;
}

/// Takes the sigmas out of the input.
SigmaParts take_sigma(HazardInput& input, const LanderStencil& lander) {
  const Grid<double> sigma = std::move(*std::exchange(input.z_sigma, std::nullopt));
  if (!input.noise_sigma) return split_sigma(sigma, Footprint::square(lander.body.half_bins()));
  return split_sigma(sigma, *std::exchange(input.noise_sigma, std::nullopt));
}

void add_probability(HazardMap& map, HazardInput& input, const HazardParameters& parameters,
                     const MapJudge& judge) {
  const bool knows_noise = input.noise_sigma.has_value();
  const bool knows_centroids = input.centroids.has_value();
  const auto measure = [&](const Grid<double>& z, const BinMask& places) { return judge.measure(z, places); };
  SafeProbability found =
      safe_probability({input.z, take_sigma(input, judge.lander()), map.measures, map.region, parameters.seed,
                        std::exchange(input.centroids, std::nullopt)},
                       judge.lander(), parameters.limits, judge.slope_base_m(), measure);
  map.p_safe = std::move(found.p);
  map.p_capped = std::move(found.capped);
  map.p_cap = found.cap;
  const double reach_m =
      static_cast<double>(safe_probability_reach(judge.lander())) * input.z.spec().resolution_m;
  map.p_safe_origin =
      "share of " + std::to_string(kSafeTerrains) + " grounds drawn from the map and its 1 sigma (" +
      (knows_noise ? "noise and relief apart" : "noise taken from its least values about a place") +
      (knows_centroids ? "; elevations moved from the centroids of the returns to the bins' centres" : "") +
      "), seed " + std::to_string(parameters.seed) + "; a place depends on the bins within " +
      short_number(reach_m) + " m";
}

std::vector<LandingSite> describe(const std::vector<BinIndex>& bins, const HazardMap& map,
                                  const Grid<double>& z) {
  std::vector<LandingSite> sites;
  for (const BinIndex bin : bins) {
    LandingSite site;
    site.bin = bin;
    site.x_m = z.spec().x(bin.col);
    site.y_m = z.spec().y(bin.row);
    site.z_m = z.at(bin);
    site.cost = map.cost.at(bin);
    site.p_touchdown = map.p_touchdown.at(bin);
    if (map.p_safe && !std::isnan(map.p_safe->at(bin))) {
      site.p_safe = map.p_safe->at(bin);
      site.p_capped = map.p_capped.at(bin) != 0;
    }
    site.slope_deg = map.measures.slope_deg.at(bin);
    site.roughness_m = map.measures.roughness_m.at(bin);
    const float distance = map.hazard_distance.at(bin);
    if (!std::isnan(distance)) site.hazard_distance_m = distance;
    if (map.truth) site.truth = static_cast<Safety>(map.truth->safe.at(bin));
    sites.push_back(site);
  }
  return sites;
}

}  // namespace

std::vector<TruthPosition> truth_positions(const Grid<double>& z_true, const Grid<double>& x_true,
                                           const Grid<double>& y_true,
                                           const std::vector<FillableBin>& holes) {
  const GridSpec& spec = z_true.spec();
  auto dx = Grid<double>::unset(spec);
  auto dy = Grid<double>::unset(spec);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      dx.at({row, col}) = x_true.at({row, col}) - spec.x(col);
      dy.at({row, col}) = y_true.at({row, col}) - spec.y(row);
    }
  std::vector<TruthPosition> positions;
  for (const FillableBin& hole : holes)
    if (!std::isfinite(z_true.at(hole.bin)))
      positions.push_back(
          {hole.bin, spec.x(hole.bin.col) + ring_mean(dx, hole), spec.y(hole.bin.row) + ring_mean(dy, hole)});
  return positions;
}

BinMask fill_truth(Grid<double>& z_true, const std::vector<FillableBin>& holes) {
  std::vector<FillableBin> missing;
  std::ranges::copy_if(holes, std::back_inserter(missing),
                       [&](const FillableBin& hole) { return !std::isfinite(z_true.at(hole.bin)); });
  fill_holes(z_true, missing);
  BinMask filled(z_true.spec());
  for (const FillableBin& hole : missing) filled.at(hole.bin) = std::isfinite(z_true.at(hole.bin)) ? 1 : 0;
  return filled;
}

HazardInput fill_map(MapLayers layers, const HazardParameters& parameters, const TruthFill& fill) {
  const std::vector<FillableBin> holes = small_holes(layers.z, parameters.hole_fill_bins);
  BinMask filled_truth = layers.z_true ? fill(*layers.z_true, holes) : BinMask(layers.z.spec());
  if (!layers.z_sigma && parameters.z_sigma_m)
    layers.z_sigma = Grid<double>(layers.z.spec(), *parameters.z_sigma_m);
  const BinMask measured = layers.z_sigma ? measured_bins(layers.z) : BinMask();
  fill_holes(layers.z, holes);
  HazardInput input{std::move(layers.z), std::move(layers.z_true), std::move(filled_truth),
                    std::move(layers.z_sigma), std::move(layers.noise_sigma)};
  if (input.z_sigma) complete_sigma(input, measured, parameters.z_sigma_m);
  if (input.z_sigma) input.centroids = std::move(layers.centroids);
  return input;
}

bool is_touchdown_capped(const LandingSite& site) {
  constexpr float kRounding = 1e-6F;
  return site.p_capped && site.p_touchdown >= site.p_safe.value_or(1) - kRounding;
}

std::string region_text(const HazardParameters& parameters) {
  if (parameters.region_shape == RegionShape::mask) return "in the mask";
  if (parameters.region_shape == RegionShape::polygon) return "in the polygon";
  const auto [x, y] = parameters.region_center_m;
  return "within " + number_text(parameters.region_radius_m) + " m of " +
         (x == 0 && y == 0 ? "the origin" : "(" + number_text(x) + ", " + number_text(y) + ") m");
}

PlaceCounts count_places(const Grid<std::int8_t>& safe, const BinMask& region) {
  PlaceCounts counts;
  for (std::size_t i = 0; i < safe.spec().size(); ++i) {
    if (region.values()[i] == 0) continue;
    const auto safety = static_cast<Safety>(safe.values()[i]);
    ++(safety == Safety::safe ? counts.safe : safety == Safety::hazard ? counts.hazard : counts.unknown);
  }
  return counts;
}

RequirementVerdicts own_verdicts(const HazardMap& map, const HazardParameters& parameters) {
  return map.truth ? map.truth->score.own_requirements
                   : judge_own<HazardScore>(nullptr, parameters.own_requirements);
}

HazardMap map_hazards(HazardInput& input, const HazardParameters& parameters, const PhaseRunner& phase) {
  const GridSpec& spec = input.z.spec();
  const MapJudge judge(parameters, spec);
  HazardMap map;
  map.region = region_of(spec, input.region, parameters);
  phase("judge", [&](const ProgressCallback& progress) {
    map.measures = judge.measure(input.z, map.region, progress);
  });
  map.safe = judge_places(map.measures, parameters.limits);
  const PlaceCounts counts = count_places(map.safe, map.region);
  if (counts.unknown == counts.all()) {
    map.nothing_to_judge = unknown_reason(map.region, known_places(input.z, map.region), parameters);
    if (!input.takes_unknown || counts.all() == 0) throw FormatError(map.nothing_to_judge);
  }
  if (input.z_sigma)
    phase("probability", [&](const ProgressCallback&) { add_probability(map, input, parameters, judge); });
  if (input.z_true)
    phase("judge the truth", [&](const ProgressCallback& progress) {
      HazardMap::Truth& truth = map.truth.emplace();
      truth.measures = judge.measure(*input.z_true, map.region, progress);
      truth.safe = judge_places(truth.measures, parameters.limits);
      truth.outcome = outcomes(map.safe, truth.safe);
      truth.score = score_hazards(map.measures, truth.measures, parameters.limits, map.region,
                                  map.p_safe ? &*map.p_safe : nullptr);
      for (std::size_t i = 0; i < spec.size(); ++i)
        truth.score.filled_truth_bins += map.region.values()[i] & input.filled_truth.values()[i];
      truth.score.own_requirements = judge_own(&truth.score, parameters.own_requirements);
    });
  phase("sites", [&](const ProgressCallback&) {
    map.p_touchdown =
        touchdown_probability(counted_probability(map), parameters.touchdown_sigma_m, map.region);
    map.cost = landing_cost(map.p_touchdown, parameters.sites);
    map.hazard_distance = hazard_distance(map.safe, map.region);
    map.sites = describe(choose_sites(map.cost, map.safe, parameters.sites), map, input.z);
  });
  return map;
}

std::optional<WorstPoses> worst_poses(const Grid<double>& z, const HazardParameters& parameters,
                                      BinIndex place) {
  const double resolution_m = z.spec().resolution_m;
  const LanderStencil lander(lander_for(parameters, resolution_m), resolution_m);
  if (parameters.method == HazardMethod::contact) return worst_contact_poses(z, lander, place);
  if (parameters.method == HazardMethod::plane) return least_squares_poses(z, lander, place);
  return {};
}

}  // namespace landfall
