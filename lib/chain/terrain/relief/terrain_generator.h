// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "base/raster/grid.h"
#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/relief/feature_field.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// The result of generate_terrain.
struct GeneratedTerrain {
  Grid<double> nodes;
  std::string crs_wkt;                 ///< of the first imported DEM's site frame, else kLocalSiteCrsWkt
  std::vector<DemSource> dem_sources;  ///< one per DemBase, in their order
  std::vector<PlacedFeature> features;
  std::optional<Grid<float>> albedo{};  ///< in [0, 1], NaN in holes; if the model has one
};

/// Throws UsageError, naming the position in the model, where generate_terrain() would before it loads a DEM
/// or draws at random: validate() of the model; more than 2^30 nodes; an explicit longest wavelength of a
/// fractal that is not above twice the resolution, since the grid would hold no wave; patches of albedo for
/// which it is above the width of the grid, too; a standing feature whose centre is off the grid.
void validate(const TerrainModel& model, const GridSpec& spec);

/// Builds a gridded terrain: the sum of the bases at each node, then the features (feature_field.h). Fractal
/// base number i (counted among all bases) draws its own waves; one without a longest wavelength draws those
/// that no DEM has, shorter than twice the finest posting. Holes of any base are holes of the terrain, even
/// under features. The albedo is that of the ground (terrain_albedo.h) and of the features (feature_field.h).
///
/// Throws UsageError as validate() does, and, without a DEM, for an elevation farther than 1e12 m from 0;
/// FormatError for such an elevation with a DEM, where a DEM is refused (no finite node, NaN at the centre
/// with Datum::center, a node outside the raster, or by the loader itself), where a standing feature's centre
/// is on a hole, or for an albedo from a raster, at a node with an elevation, that is not in [0, 1]; all name
/// the cause. The result does not depend on the number of threads.
[[nodiscard]] GeneratedTerrain generate_terrain(const TerrainModel& model, const GridSpec& spec,
                                                const DemLoader& load_dem,
                                                const ProgressCallback& progress = {});

}  // namespace landfall
