// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/relief/terrain_generator.h"

#include <utility>

#include "terrain/relief/terrain_strips.h"

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
