// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/raster/grid.h"

namespace landfall {

/// The details of a map at one scale (scale_filter.h), and their noise.
struct ScaleDetails {
  const Grid<float>& detail_m;
  const Grid<float>& noise_m2;  ///< variance that noise gives the detail; > 0
  const Grid<float>& seen;      ///< share of the bins behind the detail that were measured, 0 .. 1
  std::int64_t step = 1;        ///< bins between the taps
};

/// The distribution of the true details, given those of the map: normal about gain times the detail.
struct ScaleRelief {
  Grid<float> gain;       ///< 0 .. 1
  Grid<float> spread_m2;  ///< variance
  /// Variance of the true details about each bin that were seen, blurred over the scale.
  Grid<float> relief_m2;
};

/// Side of the cells of ground that share their probabilities, in bins: 0.6 m, and at least 2 bins.
[[nodiscard]] std::int64_t prior_cell_bins(double resolution_m);
/// The bins within which relief_of() depends on details and noise.
[[nodiscard]] std::int64_t relief_reach_bins(std::int64_t step, double resolution_m);

/// The detail is the true one plus noise of variance V. The amount of relief is estimated from the map
/// itself, by a mixture of normal distributions (Portilla, Strela, Wainwright and Simoncelli, IEEE Trans.
/// Image Processing 12, 2003): the true detail has the variance r V, where r is one of 11 classes from 0 to
/// 4000.
///  - The likelihood of a class is that of the mean square of the details about the bin (blurred over the
///    scale) with 11.5 degrees of freedom.
///  - The probabilities of the classes are those of the ground around: from equal ones, two steps of
///    expectation and maximisation over cells of 0.6 m, blurred over 5 x 5 cells. So a plane is all smooth,
///    and a boulder field smooth between its rocks.
///  - Natural relief falls with its wavelength: a class that is rougher than the next coarser scale about the
///    bin (`coarser`, relief_m2 of that scale; null at the coarsest) is less likely by exp(-x^2 / 2), x =
///    ln(r V / coarser) / 0.4.
/// Where less than half of the bins were measured, the detail counts less and the mean relief of the
/// surrounding cells counts more.
///
/// The cells begin at bin (0, 0): a bin's result does not depend on the map's extent.
[[nodiscard]] ScaleRelief relief_of(const ScaleDetails& scale, const Grid<float>* coarser);

}  // namespace landfall
