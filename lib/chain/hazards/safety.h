// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/core/fields.h"
#include "base/dictionary/requirement.h"
#include "base/raster/region.h"
#include "chain/hazards/measures.h"

namespace landfall {

struct HazardLimits {
  double slope_deg = 10;     ///< in [0, 90]
  double roughness_m = 0.3;  ///< >= 0
};

/// The judgement of a place; the value in the layer `safe`.
enum class Safety : std::int8_t { hazard = 0, safe = 1, unknown = 2 };

/// Safe where slope and roughness are at most their limits; unknown where they are NaN, and outside the
/// places that were measured.
[[nodiscard]] Grid<std::int8_t> judge_places(const PlaceMeasures& measures, const HazardLimits& limits);

/// The judgement of the map compared with the true place; the value in the layer `outcome`.
enum class HazardOutcome : std::int8_t {
  hazard_found = 0,
  safe_found = 1,
  missed_hazard = 2,
  false_alarm = 3,
  unknown = 4  ///< in the judged or in the true map
};

[[nodiscard]] Grid<std::int8_t> outcomes(const Grid<std::int8_t>& judged, const Grid<std::int8_t>& truth);

/// A fraction whose denominator is 0 is empty.
struct HazardScore {
  struct Counts {  ///< places, named by the judgement of the map and the truth
    std::int64_t safe_safe = 0, safe_hazard = 0, hazard_safe = 0, hazard_hazard = 0, unknown = 0;
    LANDFALL_FIELDS(safe_safe, safe_hazard, hazard_safe, hazard_hazard, unknown)
  };
  struct Rates {
    std::optional<double> missed_hazard_frac;  ///< judged safe, of the true hazards
    std::optional<double> false_alarm_frac;    ///< judged a hazard, of the truly safe
    LANDFALL_FIELDS(missed_hazard_frac, false_alarm_frac)
  };
  struct RocPoint {
    double roughness_limit_m = 0;
    Rates rates;
  };
  struct ReliabilityBin {
    double p_low = 0, p_high = 0;  ///< p_low <= p_safe < p_high; the last bin holds 1
    std::int64_t count = 0;
    std::optional<double> safe_frac;  ///< of the places, truly
  };

  Counts counts;
  std::int64_t filled_truth_bins = 0;
  Rates rates;
  std::vector<RocPoint> roc;    ///< 21 limits of the judged map from 0 to twice its own; the truth's stay
  std::optional<double> brier;  ///< mean of (p_safe - [truly safe])^2
  std::vector<ReliabilityBin> reliability;  ///< ten, or none without p_safe
  RequirementVerdicts own_requirements = {};

  /// The numbers on which a user can set requirements.
  static void fields(auto& walk, auto& m) {
    walk("counts", m.counts);
    walk("filled_truth_bins", m.filled_truth_bins);
    Rates::fields(walk, m.rates);
    walk("brier", m.brier);
  }
};

/// Compares the judged places of the region with the true ones. `p_safe` may be null.
[[nodiscard]] HazardScore score_hazards(const PlaceMeasures& judged, const PlaceMeasures& truth,
                                        const HazardLimits& limits, const BinMask& region,
                                        const Grid<float>* p_safe);

}  // namespace landfall
