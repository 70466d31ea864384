// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/raster/grid.h"
#include "chain/hazards/return_centroids.h"

namespace landfall {

/// The terrains that may lie under a map, given the elevations and the noise of its bins, at the bins'
/// centres. Conditional simulation: a draw agrees with the map as well as its noise allows,
/// and is as rough as the map itself says.
///
/// The map is decomposed into details of 1, 2, 4, ... bins (scale_filter.h), up to a reach of 4 m. At each
/// scale the true detail is normal about a part of that of the map (relief_prior.h): none on a plane, nearly
/// all where relief stands out of the noise. The means over the bins of a draw are the smooth rest, plus at
/// each scale the expected detail and the detail of a new white noise, scaled to its spread.
///
/// The elevation at a bin's centre is its mean m less s^2 / 24 times the Laplacian of the means, to second
/// order in the edge s: m + (m - the mean of its four neighbours) / 6. About that it departs by a normal
/// draw, since there is relief within the bin. Its variance follows from the relief of the two finest scales,
/// v1 and v2: v1 min(v1 / v2, 1), one scale finer by the same factor. A departure is at most the second
/// smallest difference of the bin from the eight around it: next to a wall, the terrain of each side is even.
///
/// The elevation of a bin is that at the mean position of its returns, which scan patterns move alike in
/// neighbouring bins: on slopes this is no noise that is independent from bin to bin. Where these positions
/// are known, elevations are first moved to the bins' centres, along the plane fitted to the 3 x 3 bins
/// about each; not in the outermost bins of a map.
///
/// Bins that were not measured are interpolated, with the relief of the measured bins around them.
class TerrainPosterior {
 public:
  /// z counts where its noise is not NaN. `seed` chooses the draws. Without centroids the elevations are
  /// those at the bins' centres.
  TerrainPosterior(const Grid<double>& z, const Grid<float>& noise_m, std::uint64_t seed,
                   std::optional<ReturnCentroids> centroids = std::nullopt);

  /// A terrain. NaN where no measured bin lies within about 3 m. The noise of a bin is a function of seed,
  /// number and the bin's index from the origin.
  [[nodiscard]] Grid<double> draw(std::uint64_t number) const;

  /// The bins within which a draw's bin depends on the map.
  [[nodiscard]] static std::int64_t reach_bins(double resolution_m);

 private:
  [[nodiscard]] std::int64_t scales() const { return static_cast<std::int64_t>(spread_.size()); }
  void add_details(std::vector<Grid<float>> details, const Grid<float>& seen, const Grid<float>& variance);

  std::uint64_t seed_;
  Grid<double> mean_;
  std::vector<Grid<float>> spread_;  ///< of each scale: what multiplies the details of white noise
  Grid<float> rest_;                 ///< what multiplies the rest of white noise
  Grid<float> departure_;            ///< 1 sigma of the elevation at the centre about its expectation
};

}  // namespace landfall
