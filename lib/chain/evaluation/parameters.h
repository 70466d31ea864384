// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/fields.h"
#include "base/dictionary/requirement.h"
#include "base/raster/footprint.h"
#include "base/raster/region.h"

namespace landfall {

/// Table 1 of Chen et al.: a value equal to its limit passes.
struct EvaluationLimits {
  double invalid_share = 0.01;     ///< invalid bins over all bins of the region
  std::int64_t hole_size = 10;     ///< bins of one hole
  double hole_depth = 1;           ///< bins from an invalid bin to the nearest valid one
  double relative_z_m = 0.05;      ///< of z in every footprint
  double relative_xy_m = 0.05;     ///< of x and of y in every footprint
  double horizontal_m = 1;         ///< hypot(abs_x, abs_y) of a footprint
  double horizontal_share = 0.95;  ///< fraction of footprints that must keep it

  /// The relative limits by axis.
  [[nodiscard]] std::array<double, 3> relative_m() const {
    return {relative_xy_m, relative_xy_m, relative_z_m};
  }
  /// The keys of eval.limits.
  static void fields(auto& walk, auto& m) {
    walk("invalid_frac", m.invalid_share);
    walk("hole_bins", m.hole_size);
    walk("distance_bins", m.hole_depth);
    walk("relative_elevation_m", m.relative_z_m);
    walk("relative_horizontal_m", m.relative_xy_m);
    walk("absolute_horizontal_m", m.horizontal_m);
    walk("absolute_horizontal_frac", m.horizontal_share);
  }
  friend bool operator==(const EvaluationLimits&, const EvaluationLimits&) = default;
};

/// The limit of a key of eval.limits; none for another word.
[[nodiscard]] std::optional<double> limit_of_key(const EvaluationLimits& limits, std::string_view key);

/// The limit that the scale of a layer of an evaluation shows, by schemas/dictionary/layers.json; none of
/// most.
[[nodiscard]] std::optional<double> limit_of_layer(const EvaluationLimits& limits, std::string_view layer);

enum class FootprintShape { square, disc };

struct EvaluationParameters {
  RegionShape region_shape = RegionShape::circle;
  double region_radius_m = 50;      ///< of the circle
  Horizontal region_center_m = {};  ///< of the circle; the origin is the intended landing site
  double region_half_width_m = 50;  ///< of the square about the origin
  double footprint_m = 1.7;         ///< edge of the square, or diameter of the disc, of the lander
  FootprintShape footprint_shape = FootprintShape::square;
  double quantile = 0.95;  ///< of |e - mean| in a footprint (Eq. 12)
  EvaluationLimits limits;
  std::vector<Requirement> own_requirements = {};  ///< on numbers of Metrics
  friend bool operator==(const EvaluationParameters&, const EvaluationParameters&) = default;
};

/// Throws UsageError, naming the key, unless lengths are finite and positive, fractions and the quantile lie
/// in [0, 1], and the other limits are finite and not negative.
void check(const EvaluationParameters& parameters);

/// The bins whose centre lies within footprint_m / 2 of the centre bin's, inclusive. The square holds the
/// bins up to h = floor(R) along either axis, R = footprint_m / (2 resolution_m) + 1e-9; the disc holds i^2 +
/// j^2 <= R^2. The slack of 1e-9 bins absorbs the division's rounding. Throws UsageError if h exceeds 2^20.
[[nodiscard]] Footprint footprint_of(const EvaluationParameters& parameters, double resolution_m);

/// The bins on an edge of the smallest footprint that has relative errors: the deviations of fewer bins from
/// their own mean say little of the ground under a lander, and one bin deviates by 0 (D450).
inline constexpr std::int64_t kMinFootprintBins = 5;

/// Whether relative errors are judged; `footprint_bins` is Footprint::edge_bins().
[[nodiscard]] constexpr bool judges_relative_errors(std::int64_t footprint_bins) {
  return footprint_bins >= kMinFootprintBins;
}

/// "5 x 5".
[[nodiscard]] std::string square_text(std::int64_t edge_bins);

/// The coarsest posting at which the relative errors of a footprint are judged.
[[nodiscard]] double coarsest_judged_posting_m(const EvaluationParameters& parameters);

/// One sentence that says why the relative errors are not judged and names coarsest_judged_posting_m();
/// nothing where they are judged.
[[nodiscard]] std::optional<std::string> why_not_judged(const EvaluationParameters& parameters,
                                                        double resolution_m);

/// The limits above which footprints fail: infinite for relative errors that are not judged.
[[nodiscard]] EvaluationLimits effective_limits(const EvaluationParameters& parameters,
                                                const Footprint& footprint);

/// The bins that are judged; `mask` holds those of RegionShape::mask and polygon. Throws UsageError for a
/// region that does not fit the DEM, FormatError for a mask that is missing, has another grid or no bin.
[[nodiscard]] BinMask judged_region(const EvaluationParameters& parameters, const GridSpec& dem,
                                    const BinMask* mask);

}  // namespace landfall
