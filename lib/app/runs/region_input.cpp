// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/region_input.h"

#include <utility>
#include <vector>

#include "formats/gdal/gdal_loader.h"
#include "store/files/evaluation_file.h"

namespace landfall {
namespace {

/// Adds the file of a region to the inputs, and warns of the assumptions about it.
void record(const RegionSource& source, const RegionMap& map, const std::string& file_id,
            std::vector<std::string> assumed, Provenance& provenance) {
  if (map.warn)
    for (const std::string& sentence : assumed) map.warn(source.path + ": " + sentence);
  provenance.add_input("region", file_id, nlohmann::json::array(), std::move(assumed));
}

BinMask mask_of(const RegionSource& source, const RegionMap& map, Provenance& provenance) {
  RegionMask read = read_region_mask(source.path, source.layer, {map.name, map.grid, map.crs_wkt, map.rules});
  record(source, map, read.file_id, std::move(read.said), provenance);
  return std::move(read.mask);
}

std::vector<Polygon> polygons_of(const RegionSource& source, const RegionMap& map, Provenance& provenance) {
  if (source.path.empty()) return source.polygons;
  PolygonFile file = polygon_file({source.path, source.layer, map.crs_wkt, map.rules.same_frame});
  record(source, map, content_id(source.path), std::move(file.assumed), provenance);
  return std::move(file.polygons);
}

}  // namespace

std::optional<BinMask> read_region(const RegionConfig& region, const RegionMap& map, const std::string& name,
                                   Provenance& provenance) {
  if (!region.source) return std::nullopt;
  const RegionSource& source = *region.source;
  if (source.shape == RegionShape::mask) return mask_of(source, map, provenance);
  const std::vector<Polygon> polygons = polygons_of(source, map, provenance);
  if (map.is_clipped) return clipped_polygons(map.grid, polygons);
  return polygon_region(map.grid, polygons, source.path.empty() ? name + ": /region/vertices" : source.path);
}

}  // namespace landfall
