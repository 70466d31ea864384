// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/numerics/random_seed.h"
#include "base/raster/grid.h"
#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/relief/large_fractal.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// The grid of a terrain and its seed.
struct AlbedoSite {
  GridSpec grid;
  RandomSeed seed = {};
  std::int64_t max_nodes = 0;  ///< grids with more have a LargeFractal (StripSize::max_nodes)
};

/// Throws UsageError unless the longest wavelength of patches is above twice the resolution of the grid, as
/// that of a fractal, and at most the grid's width: the variance of longer waves depends on the place.
void validate(const AlbedoModel& model, const GridSpec& grid);

/// The albedo of the ground without features.
///
/// - A number: that number.
/// - AlbedoGradient: from + (to - from) clamp(1/2 + s / L, 0, 1), s = x cos(azimuth) + y sin(azimuth), L the
///   length, or what the grid extends along the azimuth.
/// - AlbedoPatches: `albedo` where a fractal of its own draw is above the quantile 1 - cover_frac of a normal
///   distribution with the expected variance of its waves, else `albedo_between`.
/// - AlbedoRaster: offset + scale times the interpolated raster.
class TerrainAlbedo {
 public:
  /// Loads the raster, synthesises long waves. Throws as `load_dem` does.
  TerrainAlbedo(const AlbedoModel& model, const AlbedoSite& site, const DemLoader& load_dem);

  /// The albedo of some rows of the grid; rows in order from south to north cost least. What a raster lacks
  /// is NaN.
  [[nodiscard]] Grid<float> layer(const GridSpec& rows);

  /// Sets the holes of the elevations `z` to NaN. Throws FormatError, naming the first such node, if
  /// the albedo of a node with an elevation, which then comes from the raster, is not in [0, 1].
  void finish(Grid<float>& layer, const Grid<double>& z) const;

 private:
  void fill(Grid<float>& layer, double albedo) const;
  void fill(Grid<float>& layer, const AlbedoGradient& gradient) const;
  void fill(Grid<float>& layer, const AlbedoPatches& patches);
  void fill(Grid<float>& layer, const AlbedoRaster& raster) const;

  AlbedoModel model_;
  AlbedoSite site_;
  std::optional<DemRaster> raster_;            ///< of AlbedoRaster
  std::optional<LargeFractal> large_fractal_;  ///< of AlbedoPatches on a large grid
};

}  // namespace landfall
