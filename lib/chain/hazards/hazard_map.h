// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "base/geometry/map_position.h"
#include "chain/hazards/hole_filling.h"
#include "chain/hazards/pose.h"
#include "chain/hazards/return_centroids.h"
#include "chain/hazards/safety.h"
#include "chain/hazards/sites.h"

namespace landfall {

/// How slope and roughness of a place are measured: measure_contact() etc.
enum class HazardMethod { contact, plane, range_difference, lmeds };

struct HazardParameters {
  Lander lander;
  HazardMethod method = HazardMethod::contact;
  RegionShape region_shape = RegionShape::circle;
  double region_radius_m = 50;      ///< of the circle, > 0
  Horizontal region_center_m = {};  ///< of the circle
  HazardLimits limits;
  std::int64_t hole_fill_bins = 10;  ///< >= 0
  std::optional<double> z_sigma_m;   ///< of maps without a sigma of their own
  double touchdown_sigma_m = 1;      ///< >= 0
  SiteParameters sites;
  std::uint64_t seed = 1;                          ///< of the terrains that p_safe is computed from
  std::vector<Requirement> own_requirements = {};  ///< on numbers of HazardScore
};

/// A map with its small holes filled, and the true terrain of its bins.
struct HazardInput {
  Grid<double> z;
  std::optional<Grid<double>> z_true;
  BinMask filled_truth;  ///< bins whose truth is a mean of their surroundings; only with z_true
  /// 1 sigma of each measured bin, NaN elsewhere, also in filled holes; with it the map has p_safe.
  std::optional<Grid<double>> z_sigma;
  /// Its part that is noise, independent of other bins.
  std::optional<Grid<double>> noise_sigma = std::nullopt;
  /// Bins with a measured elevation and without a sigma: p_safe does not use their elevations.
  std::int64_t bins_without_sigma = 0;
  std::optional<BinMask> region = std::nullopt;  ///< the places, if the region's shape is mask or polygon
  std::optional<ReturnCentroids> centroids = std::nullopt;  ///< for p_safe
  /// Whether a map on which no place of the region can be judged is a result: the worst of a run of draws or
  /// of a study. A region without a bin never is.
  bool takes_unknown = false;
};

/// A bin of a filled hole that has no true elevation, and the position at which it is taken from the terrain.
struct TruthPosition {
  BinIndex bin;
  double x_m = 0, y_m = 0;
};

/// The true positions of the bins of small holes without a true elevation: the bin's centre, moved by the
/// mean (x_true - X, y_true - Y) of the bins in its ring.
[[nodiscard]] std::vector<TruthPosition> truth_positions(const Grid<double>& z_true,
                                                         const Grid<double>& x_true,
                                                         const Grid<double>& y_true,
                                                         const std::vector<FillableBin>& holes);

/// Gives each bin of `holes` without a true elevation the mean of its ring in z_true. Returns those that got
/// one.
[[nodiscard]] BinMask fill_truth(Grid<double>& z_true, const std::vector<FillableBin>& holes);

/// Completes the true elevations of the bins of filled holes. Returns those that got a mean of their
/// surroundings.
using TruthFill = std::function<BinMask(Grid<double>& z_true, const std::vector<FillableBin>& holes)>;

/// The layers of a map; elevations may have holes.
struct MapLayers {
  Grid<double> z;
  std::optional<Grid<double>> z_true = std::nullopt;
  std::optional<Grid<double>> z_sigma = std::nullopt;
  std::optional<Grid<double>> noise_sigma = std::nullopt;   ///< only with z_sigma
  std::optional<ReturnCentroids> centroids = std::nullopt;  ///< only with z_sigma
};

/// The map with its small holes filled, its truth completed by `fill`, and z_sigma_m for the measured bins
/// that have no 1 sigma of their own. Without a sigma for any bin, the input has no z_sigma.
[[nodiscard]] HazardInput fill_map(MapLayers layers, const HazardParameters& parameters,
                                   const TruthFill& fill);

/// The region in words: "within 50 m of the origin".
[[nodiscard]] std::string region_text(const HazardParameters& parameters);

/// A place to land, chosen by SiteParameters.
struct LandingSite {
  BinIndex bin;
  double x_m = 0, y_m = 0, z_m = 0;
  float cost = 0;
  float p_touchdown = 0;
  std::optional<float> p_safe;
  bool p_capped = false;  ///< p_safe is as large as the evidence allows: the probability is at least p_safe
  double slope_deg = 0, roughness_m = 0;
  std::optional<float> hazard_distance_m;  ///< none without a place that is not safe
  Safety truth = Safety::unknown;
  MapPosition map = {};  ///< set by the caller, who has the CRS of the file
};

/// Whether p_touchdown too is as large as the evidence allows: all about the site is at that bound.
[[nodiscard]] bool is_touchdown_capped(const LandingSite& site);

/// Text in place of a probability if HazardMap::p_safe is not given: of a map without 1-sigmas, and of one
/// whose 1-sigmas were left out.
inline constexpr const char* kNoProbability = "no probability: the map has no 1-sigma layer";
inline constexpr const char* kProbabilityLeftOut = "no probability: --layers leaves out the map's 1-sigmas";

struct HazardMap {
  BinMask region;
  PlaceMeasures measures;
  Grid<std::int8_t> safe;
  std::optional<Grid<float>> p_safe;  ///< safe_probability(); none without z_sigma
  BinMask p_capped;                   ///< only with p_safe, as p_cap
  float p_cap = 0;
  std::string p_safe_origin;  ///< how it was made, in words
  std::string no_probability = kNoProbability;
  Grid<float> p_touchdown;
  Grid<float> cost;
  Grid<float> hazard_distance;

  struct Truth {
    PlaceMeasures measures;
    Grid<std::int8_t> safe;
    Grid<std::int8_t> outcome;
    HazardScore score;
  };
  std::optional<Truth> truth;
  std::vector<LandingSite> sites;  ///< best first
  std::string nothing_to_judge;    ///< why every place is unknown; empty if one is not
};

/// The places of the region by their safety.
struct PlaceCounts {
  std::int64_t hazard = 0, safe = 0, unknown = 0;
  [[nodiscard]] std::int64_t all() const { return hazard + safe + unknown; }
};
[[nodiscard]] PlaceCounts count_places(const Grid<std::int8_t>& safe, const BinMask& region);

/// The user's own requirements on the score; without truth no number of it is known.
[[nodiscard]] RequirementVerdicts own_verdicts(const HazardMap& map, const HazardParameters& parameters);

/// Judges every place of the region: those of the input, or the circle (clipped_circle()). Takes the sigmas
/// out of the input, since their memory is needed.
///
/// Throws UsageError "lander/KEY: ..." or "limits/roughness_m: ..." for what the map cannot hold or resolve,
/// FormatError that says why if every place is unknown and the input does not take that.
[[nodiscard]] HazardMap map_hazards(HazardInput& input, const HazardParameters& parameters,
                                    const PhaseRunner& phase);

/// The poses that give a place of the filled map its slope and roughness. None at an unknown place, and for a
/// method whose measures are not those of one pose.
[[nodiscard]] std::optional<WorstPoses> worst_poses(const Grid<double>& z, const HazardParameters& parameters,
                                                    BinIndex place);

}  // namespace landfall
