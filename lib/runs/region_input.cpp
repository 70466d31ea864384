// SPDX-License-Identifier: GPL-3.0-or-later
#include "runs/region_input.h"

#include <utility>
#include <vector>

#include "files/evaluation_file.h"
#include "terrain/gdal/gdal_loader.h"

namespace landfall {
namespace {

constexpr const char* kRole = "region";

BinMask mask_of(const RegionSource& source, const GridSpec& grid, Provenance& provenance) {
  RegionMask read = read_region_mask(source.path, source.layer, grid);
  provenance.add_input(kRole, read.file_id, nlohmann::json::array());
  return std::move(read.mask);
}

std::vector<Polygon> polygons_of(const RegionSource& source, const std::string& crs_wkt,
                                 Provenance& provenance) {
  if (source.path.empty()) return source.polygons;
  PolygonFile file = polygon_file({source.path, source.layer, crs_wkt});
  std::vector<std::string> assumed;
  if (file.crs_name.empty()) assumed.emplace_back("has no CRS: its coordinates are x and y of the DEM frame");
  provenance.add_input(kRole, content_id(source.path), nlohmann::json::array(), std::move(assumed));
  return std::move(file.polygons);
}

}  // namespace

std::optional<BinMask> read_region(const RegionConfig& region, const RegionMap& map, const std::string& name,
                                   Provenance& provenance) {
  if (!region.source) return std::nullopt;
  const RegionSource& source = *region.source;
  if (source.shape == RegionShape::mask) return mask_of(source, map.grid, provenance);
  const std::vector<Polygon> polygons = polygons_of(source, map.crs_wkt, provenance);
  if (map.is_clipped) return clipped_polygons(map.grid, polygons);
  return polygon_region(map.grid, polygons, source.path.empty() ? name + ": /region/vertices" : source.path);
}

}  // namespace landfall
