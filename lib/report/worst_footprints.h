// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "evaluation/evaluate.h"

namespace landfall::html_report {

/// value / limit; without a limit (0) infinite, and 0 where the value is 0 too. NaN for NaN.
[[nodiscard]] double share_of_limit(double value, double limit);

/// The largest values of a map that lie apart: the largest, then the largest of the bins that are more than
/// 2 half_bins rows or columns from all chosen before, and so on; of equal ones the first in row-major order.
/// NaN is never chosen; at most `count`.
[[nodiscard]] std::vector<BinIndex> largest_apart(const Grid<float>& map, std::int64_t half_bins,
                                                  std::size_t count);

/// A part of a DEM, all layers on the grid asked for, which lies within the DEM's.
using DemWindow = std::function<DemLayers(const GridSpec& window)>;

/// A footprint that is close to its limits, or over one, and its surroundings.
struct WorstFootprint {
  BinIndex bin;
  double absolute_m[3] = {};  ///< of x, y, z
  double relative_m[3] = {};
  double horizontal_m = 0;  ///< hypot of the absolute x and y
  double share = 0;         ///< the largest of its values over its limit
  std::string
      requirement;  ///< whose limit that is: relative_elevation, relative_horizontal, absolute_horizontal
  char axis = 'z';  ///< whose error it is; 'h' for the horizontal one
  GridSpec window;  ///< what is shown: the footprint and as much again on each side, within the DEM
  Grid<double> z_est;
  Grid<double> error;  ///< of the axis
};

/// Measures the footprint about `bin` again, from the DEM itself, as evaluate() did.
[[nodiscard]] WorstFootprint measure_footprint(BinIndex bin, const GridSpec& dem,
                                               const EvaluationParameters& parameters, const DemWindow& read);

/// The footprints, at most ten, with the largest shares of their limits that do not overlap; none of an empty
/// map.
[[nodiscard]] std::vector<WorstFootprint> worst_footprints(const Grid<float>& shares,
                                                           const EvaluationParameters& parameters,
                                                           const DemWindow& read);

}  // namespace landfall::html_report
