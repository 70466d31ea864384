// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/core/progress.h"
#include "base/raster/grid.h"
#include "chain/terrain/features/feature.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// A feature of a terrain.
struct PlacedFeature {
  Feature feature;
  std::int32_t pattern = -1;            ///< number of the pattern that it comes from; -1: listed individually
  std::int64_t number = 0;              ///< among the listed features or those of its pattern
  std::optional<double> ground_m = {};  ///< elevation of the ground under its centre, once seated
  bool is_random = false;               ///< its position is random

  friend bool operator==(const PlacedFeature&, const PlacedFeature&) = default;
};

/// Throws UsageError, naming it, for the first standing feature with a fixed position whose centre is off the
/// grid. Features at random positions are not checked.
void require_on_grid(const TerrainModel& model, const GridSpec& grid);

/// All features of a terrain: the listed ones, then those of the patterns, each in their order. The ground is
/// the sum of the bases, plus the features of the role `adds` in their order, plus the highest relief of
/// those that drape; those that stand on it come last. Everything is evaluated at nodes only.
///
/// A terrain may be made as one grid or in parts, whose nodes get the same elevations: first call
/// shape_ground() for every part, then seat() for every part, then stand() for every part.
class FeatureField {
 public:
  /// Places the features of a validated model on `grid`. Throws UsageError as require_on_grid().
  FeatureField(const TerrainModel& model, const GridSpec& grid);

  /// `part`: some of the grid's nodes, holding the sum of the bases. `albedo`: null, or the albedo of the
  /// same nodes. A node on the footprint of a feature that adds takes the albedo of its kind, if the model
  /// gives one, the last one's of several; then that of the highest feature that drapes over it.
  void shape_ground(Grid<double>& part, const ProgressCallback& progress = {},
                    Grid<float>* albedo = nullptr) const;
  /// Finds in `part` the ground under the centres that lie on it and have none yet. Centres on its last row
  /// count only where that is the grid's last row, since the cell there lies in the next part. So that every
  /// centre finds its cell and that cell's neighbours to the south, parts must be full rows, be given from
  /// south to north, and overlap: see TerrainStrips. Throws FormatError, naming the feature, if a standing
  /// feature at a fixed position is on a hole; one at a random position is seated at NaN and does not appear.
  void seat(const TriangulatedGrid& part);
  /// Throws std::logic_error if a standing feature that lies on the part is not seated. Holes of the ground
  /// stay holes. Nodes that become the surface of a standing feature take the `albedo` of its kind, as in
  /// shape_ground().
  void stand(Grid<double>& part, const ProgressCallback& progress = {}, Grid<float>* albedo = nullptr) const;

  /// Whether all standing features that reach rows [begin, end) of the grid, counted from 0, are seated.
  [[nodiscard]] bool can_stand(std::int64_t begin, std::int64_t end) const;

  [[nodiscard]] const std::vector<PlacedFeature>& features() const { return features_; }

 private:
  GridSpec grid_;
  AlbedoModel albedo_;
  std::vector<PlacedFeature> features_;
};

}  // namespace landfall
