// SPDX-License-Identifier: GPL-3.0-or-later
//
// Elevations farther than 1e12 m from 0 are refused at every node, like the coordinates of a mesh: exit 2
// without a raster, exit 1 with one, whose undeclared nodata value is the likely cause.
//
// A fractal's longest wavelength that is given and does not exceed twice the resolution of the grid is
// refused, because no wave would be left; if it comes from a raster as fine as the grid, an empty layer is
// the requested result.
#include "chain/terrain/relief/terrain_generator.h"

#include <utility>

#include "chain/terrain/relief/terrain_strips.h"

namespace landfall {

GeneratedTerrain generate_terrain(const TerrainModel& model, const GridSpec& spec, const DemLoader& load_dem,
                                  const ProgressCallback& progress) {
  StripSize size;
  size.rows = spec.rows;  // makes a single strip
  TerrainStrips strips(model, spec, load_dem, size,
                       [&](double fraction) { report(progress, 0.1 * fraction); });
  GeneratedTerrain terrain{{}, strips.crs_wkt(), strips.dem_sources(), {}};
  strips.make(
      [&](TerrainStrip strip) {
        terrain.nodes = std::move(strip.nodes);
        terrain.albedo = std::move(strip.albedo);
      },
      [&](double fraction) { report(progress, 0.1 + 0.9 * fraction); });
  terrain.features = strips.features();
  return terrain;
}

}  // namespace landfall
