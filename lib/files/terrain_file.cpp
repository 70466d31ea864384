// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/terrain_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "base/hash.h"
#include "files/crs.h"
#include "files/feature_file.h"
#include "files/grid_file.h"
#include "files/mesh_terrain_file.h"
#include "terrain/site_wkt.h"

namespace landfall {

namespace {

TerrainIdentity identity_of(const LandfallFileReader& file) {
  return {read_crs(file.root()), file.file_id(), file.chain()};
}

}  // namespace

void write_terrain(LandfallFileWriter& file, const GeneratedTerrain& terrain) {
  GridLayerWriter layers(file, terrain.nodes.spec(), terrain.crs_wkt, "grid node");
  layers.write("z", terrain.nodes);
  if (terrain.albedo) layers.write("albedo", *terrain.albedo);
  write_features(file, terrain.features);
  file.commit();
}

NodeCounts count_nodes(const Grid<double>& grid) {
  const auto z = grid.values();
  const auto is_hole = [](double z_m) { return std::isnan(z_m); };
  return {static_cast<std::int64_t>(z.size()), std::count_if(z.begin(), z.end(), is_hole)};
}

NodeCounts write_terrain(LandfallFileWriter& file, TerrainStrips& strips, const ProgressCallback& progress) {
  const GridLayerWriter layers(file, strips.spec(), strips.crs_wkt(), "grid node");
  const h5::Handle z_layer = layers.begin<double>("z");
  std::optional<h5::Handle> albedo_layer;
  if (strips.has_albedo()) albedo_layer = layers.begin<float>("albedo");
  ValueRange range;
  ValueRange albedo_range;
  NodeCounts written;
  const auto write = [&](const TerrainStrip& strip) {
    range.add(strip.nodes.values());
    const NodeCounts part = count_nodes(strip.nodes);
    written = {written.nodes + part.nodes, written.holes + part.holes};
    layers.write_rows(z_layer, "z", strip.nodes);
    if (!albedo_layer) return;
    albedo_range.add(strip.albedo->values());
    layers.write_rows(*albedo_layer, "albedo", *strip.albedo);
  };
  strips.make(write, progress);
  GridLayerWriter::write_range<double>(z_layer, range);
  if (albedo_layer) GridLayerWriter::write_range<float>(*albedo_layer, albedo_range);
  write_features(file, strips.features());
  file.commit();
  return written;
}

std::string raster_id(const DemRaster& raster) {
  Hash hash;
  hash.update(without_map(raster.crs_wkt)).update(std::as_bytes(std::span(raster.samples.values)));
  std::vector<double> numbers = {static_cast<double>(raster.samples.size.cols)};
  for (const SitePoint& point : {SitePoint{0, 0}, SitePoint{1, 0}, SitePoint{0, 1}}) {
    const PixelPosition pixel = raster.mapping.pixel(point);
    numbers.insert(numbers.end(), {pixel.col, pixel.row});
  }
  return hash.update(std::as_bytes(std::span(numbers))).hex();
}

TerrainIdentity read_terrain_identity(const std::filesystem::path& path) {
  return identity_of(LandfallFileReader(path, {"terrain"}));
}

TerrainInput read_terrain(const std::filesystem::path& path, const ProgressCallback& progress) {
  const LandfallFileReader file(path, {"terrain"});
  if (!h5::exists(file.root(), "z") && h5::exists(file.root(), "mesh")) {
    const auto mesh = read_mesh_terrain(file);
    report(progress, 1);
    return {identity_of(file), mesh, nullptr, mesh};
  }
  const GridLayerReader layers(file);
  Grid<double> nodes = layers.read<double>("z", progress);
  const auto values = nodes.values();
  if (std::any_of(values.begin(), values.end(), [](double z) { return std::isinf(z); }))
    file.fail("/z holds an infinite elevation");
  if (std::none_of(values.begin(), values.end(), [](double z) { return std::isfinite(z); }))
    file.fail("/z has no finite node");
  const auto grid = std::make_shared<const TriangulatedGrid>(std::move(nodes));
  return {identity_of(file), grid, grid};
}

}  // namespace landfall
