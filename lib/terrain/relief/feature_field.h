// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "raster/grid.h"
#include "terrain/features/feature.h"
#include "terrain/relief/triangulated_grid.h"
#include "terrain/terrain_model.h"

namespace landfall {

/// A feature of a terrain.
struct PlacedFeature {
  Feature feature;
  std::int32_t pattern = -1;            ///< number of the pattern that it comes from; -1: listed by itself
  std::int64_t number = 0;              ///< among the listed ones, or those of its pattern
  std::optional<double> ground_m = {};  ///< elevation of the ground under its centre, once seated
  bool by_chance = false;               ///< its position was drawn

  friend bool operator==(const PlacedFeature&, const PlacedFeature&) = default;
};

/// Throws UsageError, naming it, for the first standing feature whose centre is off the grid, of those that
/// are not drawn by chance: these never are.
void require_on_grid(const TerrainModel& model, const GridSpec& grid);

/// All features of a terrain: those that are listed, then those of the patterns, each in their order. The
/// ground is the sum of the bases, plus what features of the role `adds` add in their order, plus the highest
/// relief of those that drape; then come those that stand on it. Everything is evaluated at nodes only.
///
/// A terrain may be made in one grid or in parts, whose nodes get the same elevations: first shape_ground()
/// of every part, then seat() with every part, then stand() of every part.
class FeatureField {
 public:
  /// Places the features of a validated model on `grid`. Throws UsageError as require_on_grid().
  FeatureField(const TerrainModel& model, const GridSpec& grid);

  /// `part`: some of the grid's nodes, with the sum of the bases.
  void shape_ground(Grid<double>& part, const ProgressCallback& progress = {}) const;
  /// Asks `part` for the ground under the centres that lie on it and have none yet; those on its last row
  /// only where that is the grid's, since the cell there lies in the next part. So that every centre finds
  /// its cell and that cell's neighbours to the south, parts must be full rows, go up, and overlap: see
  /// TerrainStrips. Throws FormatError, naming the feature, where one that stands finds a hole; one that is
  /// there by chance is seated at NaN and does not appear.
  void seat(const TriangulatedGrid& part);
  /// Throws std::logic_error where a standing feature that lies on the part is not seated. A hole of the
  /// ground stays one.
  void stand(Grid<double>& part, const ProgressCallback& progress = {}) const;

  /// Whether all that stands and reaches some of the grid's rows [begin, end), counted from 0, is seated.
  [[nodiscard]] bool can_stand(std::int64_t begin, std::int64_t end) const;

  [[nodiscard]] const std::vector<PlacedFeature>& features() const { return features_; }

 private:
  GridSpec grid_;
  std::vector<PlacedFeature> features_;
};

}  // namespace landfall
