// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/bin_elevations.h"

#include "base/parallel.h"

namespace landfall {

Grid<double> bin_elevations(const TerrainSurface& terrain, const GridSpec& grid) {
  auto map = Grid<double>::unset(grid);
  parallel_for(static_cast<std::size_t>(grid.rows), 16, [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
      for (std::int64_t col = 0; col < grid.cols; ++col)
        map.at({row, col}) = terrain.elevation(grid.x(col), grid.y(row));
  });
  return map;
}

}  // namespace landfall
