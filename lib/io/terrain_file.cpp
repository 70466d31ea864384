// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/terrain_file.h"

#include <algorithm>
#include <cmath>

#include "io/grid_file.h"

namespace landfall {

void write_terrain(LandfallFileWriter& file, const GeneratedTerrain& terrain) {
  GridLayerWriter layers(file, terrain.nodes.spec(), terrain.crs_wkt);
  layers.write("z", terrain.nodes, {"m", "true elevation at the grid node"});
  file.commit();
}

TerrainInput read_terrain(const std::filesystem::path& path) {
  const LandfallFileReader file(path, {"terrain"});
  if (!h5::exists(file.root(), "z") && h5::exists(file.root(), "mesh"))
    file.fail("is a mesh terrain; this version reads gridded terrain (/x /y /z)");
  const GridLayerReader layers(file);
  Grid<double> nodes = layers.read<double>("z");
  const auto values = nodes.values();
  if (std::any_of(values.begin(), values.end(), [](double z) { return std::isinf(z); }))
    file.fail("/z holds an infinite elevation");
  if (std::none_of(values.begin(), values.end(), [](double z) { return std::isfinite(z); }))
    file.fail("/z has no finite node");
  return {std::make_shared<const TriangulatedGrid>(std::move(nodes)), layers.crs_wkt(), file.file_id(),
          file.chain()};
}

}  // namespace landfall
