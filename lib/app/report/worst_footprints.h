// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "chain/evaluation/dem_layers.h"
#include "chain/evaluation/parameters.h"

namespace landfall::html_report {

/// value / limit. If the limit is 0: infinity, or 0 if the value is 0 too. NaN for NaN.
[[nodiscard]] double share_of_limit(double value, double limit);

/// The largest values of a map that are far enough apart: the largest, then the largest of the bins that are
/// more than 2 half_bins rows or columns from all chosen before, and so on; of equal values the first in
/// row-major order. NaN is never chosen. At most `count` bins.
[[nodiscard]] std::vector<BinIndex> largest_apart(const Grid<float>& map, std::int64_t half_bins,
                                                  std::size_t count);

/// Reads a part of a DEM: all layers on the requested grid, which lies within the DEM's.
using DemWindow = std::function<DemLayers(const GridSpec& window)>;

/// A footprint that is close to or over its limits, and its surroundings.
struct WorstFootprint {
  BinIndex bin;
  double absolute_m[3] = {};  ///< of x, y, z
  double relative_m[3] = {};
  double horizontal_m = 0;  ///< hypot of the absolute x and y
  double share = 0;         ///< the largest ratio of its values to their limits
  std::string requirement;  ///< whose limit that is
  char axis = 'z';          ///< axis of that error; 'h' for the horizontal one
  GridSpec window;          ///< the part shown: the footprint and its width on each side, within the DEM
  Grid<double> z_est;
  Grid<double> error;  ///< along `axis`
};

/// Measures the footprint centred on `bin` again from the DEM itself, as evaluate() did.
[[nodiscard]] WorstFootprint measure_footprint(BinIndex bin, const GridSpec& dem,
                                               const EvaluationParameters& parameters, const DemWindow& read);

/// At most ten footprints that do not overlap, those with the largest ratios to their limits; none for an
/// empty map.
[[nodiscard]] std::vector<WorstFootprint> worst_footprints(const Grid<float>& shares,
                                                           const EvaluationParameters& parameters,
                                                           const DemWindow& read);

}  // namespace landfall::html_report
