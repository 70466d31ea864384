// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hazards/return_centroids.h"
#include "hazards/sigma_parts.h"
#include "raster/grid.h"

namespace landfall {

/// The grounds that may lie under a map, given the elevations and the 1 sigma of its bins; the ground is what
/// is at the bins' centres. Conditional simulation: a draw agrees with the map as well as its noise allows,
/// and is as rough as the map itself says.
///
/// The map is taken apart into details of 1, 2, 4, ... bins (scale_filter.h), up to a reach of 4 m. At each
/// scale the true detail is normal about a part of that of the map (relief_prior.h): none on a plane, nearly
/// all where relief stands out of the noise. A draw is the smooth rest, plus at each scale the expected
/// detail and the detail of a new white noise, scaled to its spread, plus for each bin a normal departure of
/// the ground at the centre from the mean of the returns: 0.35 of the variance that sigma has beyond noise,
/// at most the relief of the two finest scales. Means over bins are flatter than the ground: details of the
/// two finest scales are multiplied by 1.3 and 1.04.
///
/// The elevation of a bin is that at the mean position of its returns, which scan patterns move alike in
/// neighbouring bins: on slopes this is no noise that is independent from bin to bin. Where these positions
/// are known, elevations are first moved to the bins' centres, along the plane fitted to the 3 x 3 bins
/// about each; not in the outermost bins of a map.
///
/// The draw at a measured bin is bounded by the 3 x 3 elevations about it, plus 0.3 of the noise and a
/// twentieth of their range; its departure by the 3 x 3 values of the draw without it, plus 0.2 of the noise.
/// So a wall has no overshoot. Bins that were not measured are interpolated, and have the relief of the
/// measured ground around them.
class GroundPosterior {
 public:
  /// z counts where the parts of its sigma are not NaN. `seed` chooses the draws. Without centroids the
  /// elevations are those at the bins' centres.
  GroundPosterior(const Grid<double>& z, const SigmaParts& sigma, std::uint64_t seed,
                  std::optional<ReturnCentroids> centroids = std::nullopt);

  /// A ground. NaN where no measured bin lies within about 3 m. The noise of a bin is a function of seed,
  /// number and the bin's index from the origin.
  [[nodiscard]] Grid<double> draw(std::uint64_t number) const;

  /// The bins within which a draw's bin depends on the map.
  [[nodiscard]] static std::int64_t reach_bins(double resolution_m);

 private:
  [[nodiscard]] std::int64_t scales() const { return static_cast<std::int64_t>(spread_.size()); }
  void add_details(std::vector<Grid<float>> details, const Grid<float>& seen, const Grid<float>& variance,
                   Grid<float> relief_m);
  void set_bounds(const Grid<double>& z, const SigmaParts& sigma);

  std::uint64_t seed_;
  Grid<double> mean_;
  std::vector<Grid<float>> spread_;  ///< of each scale: what multiplies the details of white noise
  Grid<float> rest_;                 ///< what multiplies the rest of white noise
  Grid<float> departure_;            ///< 1 sigma of the centre about the mean of the bin
  Grid<float> noise_;                ///< 0 where not measured
  Grid<float> low_, high_;           ///< bounds less mean_
};

}  // namespace landfall
