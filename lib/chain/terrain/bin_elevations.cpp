// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/bin_elevations.h"

#include "base/raster/by_rows.h"

namespace landfall {

Grid<double> bin_elevations(const TerrainSurface& terrain, const GridSpec& grid) {
  auto map = Grid<double>::unset(grid);
  by_rows(grid, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < grid.cols; ++col)
      map.at({row, col}) = terrain.elevation(grid.x(col), grid.y(row));
  });
  return map;
}

}  // namespace landfall
