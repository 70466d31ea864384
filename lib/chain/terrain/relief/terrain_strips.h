// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "base/raster/grid.h"
#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/relief/feature_field.h"
#include "chain/terrain/relief/large_fractal.h"
#include "chain/terrain/relief/terrain_albedo.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// The size of the strips of a terrain.
struct StripSize {
  std::int64_t max_nodes = std::int64_t{1} << 26U;  ///< of a terrain that is made in one piece
  std::int64_t rows = 768;  ///< of a strip of others, >= 4; chunks of a file have 256, fractals' patches 384
};

/// Some rows of a terrain.
struct TerrainStrip {
  Grid<double> nodes;
  std::optional<Grid<float>> albedo{};  ///< if the model has one
};

/// Makes a terrain (generate_terrain()) in strips of rows, from south to north, and passes each on when it is
/// ready. A terrain of up to StripSize::max_nodes is one strip. Larger ones use LargeFractal for their
/// fractals; the nodes do not depend on the height of the strips.
///
/// Memory, besides that of the DEMs and the fractals: two strips, and those that wait for the ground under
/// the centre of a standing feature that reaches into them from farther north.
class TerrainStrips {
 public:
  /// Loads the DEMs, synthesises long waves and places the features. Throws as generate_terrain().
  TerrainStrips(TerrainModel model, const GridSpec& spec, const DemLoader& load_dem,
                const StripSize& size = {}, const ProgressCallback& progress = {});

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  /// See GeneratedTerrain.
  [[nodiscard]] std::string crs_wkt() const;
  [[nodiscard]] std::vector<DemSource> dem_sources() const;
  /// The features, which are seated once all strips have been made.
  [[nodiscard]] const std::vector<PlacedFeature>& features() const { return field_.features(); }

  [[nodiscard]] bool has_albedo() const { return albedo_.has_value(); }

  using Sink = std::function<void(TerrainStrip strip)>;
  /// Passes all strips to `sink`; may be called once. Throws as generate_terrain(), also after strips.
  void make(const Sink& sink, const ProgressCallback& progress = {});

 private:
  /// The raster of a DemBase.
  struct DemLayer {
    DemRaster raster;
    double datum_m = 0;
    bool any_finite = false;
  };

  void make_fractals(const ProgressCallback& progress);
  [[nodiscard]] double waves_without_raster_m() const;
  [[nodiscard]] bool is_whole() const { return spec_.rows * spec_.cols <= size_.max_nodes; }
  [[nodiscard]] std::vector<GridSpec> cut() const;
  [[nodiscard]] TerrainStrip ground(const GridSpec& strip, const ProgressCallback& progress);
  void require_elevations(const Grid<double>& z) const;
  void require_relief() const;
  void seat(Grid<double>& strip);
  void give_ready(const Sink& sink, const ProgressCallback& progress);

  TerrainModel model_;
  GridSpec spec_;
  StripSize size_;
  FeatureField field_;
  std::vector<DemLayer> dems_;                          ///< of the DemBases, in their order
  std::map<std::size_t, LargeFractal> large_fractals_;  ///< by number of the base; empty for a single strip
  std::optional<TerrainAlbedo> albedo_;
  std::optional<Grid<double>> border_;  ///< the last two rows of the previous strip, ground only
  std::deque<TerrainStrip> waiting_;
};

}  // namespace landfall
