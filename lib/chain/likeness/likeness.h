// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "chain/likeness/binned_scans.h"

namespace landfall {

/// One statistic of two scans. Its distance is 0 for equal scans and never negative.
struct LikenessStatistic {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::string name;
  std::string unit = {};  ///< of `a` and `b`; empty: 1
  double a = kNone;       ///< the level of each scan, if it has one
  double b = kNone;
  std::string distance_unit = {};  ///< empty: 1
  double distance = kNone;
  /// The second largest distance of kExchanges pairs of scans with blocks exchanged (exchanged_sides()). NaN:
  /// not known.
  double chance = kNone;
  double p = kNone;  ///< (1 + number of those that are at least `distance`) / (1 + kExchanges)

  /// Whether the distance is beyond chance, p <= 0.01; none where that is not known.
  [[nodiscard]] std::optional<bool> differs() const;
};
inline constexpr std::size_t kExchanges = 199;

/// How like two scans are.
struct Likeness {
  double posting_m = 0;
  std::size_t bins = 0;      ///< that either scan covers
  double block_overlap = 0;  ///< BinnedScans::block_overlap()
  std::vector<LikenessStatistic> statistics = {};
  std::vector<std::string> not_in_both = {};        ///< quantities that one scan alone has
  std::array<double, 10> covered_a{}, covered_b{};  ///< covered_over_time(); 0 where a scan has no times
  SurfaceDifference surface = {};
  /// With maps: returns per bin and mean elevations (NaN without returns) of A and B, of all bins that either
  /// covers.
  GridSpec grid = {};
  std::array<Grid<double>, 2> counts = {}, elevations = {};
};

/// Compares two scans (docs/reference/statistics.md has the definitions):
/// density        KS distance of the returns per bin; levels: returns per covered bin
/// density_map    1 - correlation of the returns per bin
/// coverage       share of the bins that only one covers; levels: covered bins
/// coverage_time  largest difference of the shares covered after each tenth of the duration; with times
/// spacing_along, spacing_across  KS distances of Spacings, of first returns; levels: medians
/// position       energy distance of 2,048 returns of each (TwoClouds)
/// elevation, elevation_spread, shift, tilt  |median|, NMAD and lengths of SurfaceDifference
/// roughness      KS distance of the heights above the plane of their bin and scan, of bins with at least 3
///                returns; levels: NMAD
/// incidence      KS distance of the angle between beam and surface normal; with lidar positions
/// and of each quantity that both have the KS distance; levels: medians, or NMAD of errors.
///
/// Bins are squares of 1, 2 or 5 x 10^k m, the largest of at most twice the largest median spacing.
/// Chance levels assume that blocks k of both scans see the same ground: statistics of places have none if
/// block_overlap is below 0.5, and elevation_spread, which exchanges hardly change, never has one. At least
/// 100 returns in each scan, of which most do not lie on one point; else throws UsageError.
[[nodiscard]] Likeness likeness_of(const ComparedScan& a, const ComparedScan& b, bool with_maps = false,
                                   const ProgressCallback& progress = {});

}  // namespace landfall
