// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/terrain_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "base/core/hash.h"
#include "base/text/joined.h"
#include "chain/terrain/site_wkt.h"
#include "store/files/crs.h"
#include "store/files/grid_file.h"
#include "store/files/mesh_terrain_file.h"
#include "store/hdf5/table.h"

namespace landfall {
namespace {

TerrainIdentity identity_of(const LandfallFileReader& file) {
  TerrainIdentity identity{read_crs(file), file.file_id(), file.chain()};
  if (h5::exists(file.root(), "z"))
    identity.spacing_m = node_spacing_m(file.config(), GridLayerReader(file).spec().resolution_m);
  return identity;
}

/// Whether the key holds no object of a terrain.
bool is_without(const nlohmann::json& config, const char* key) {
  const auto found = config.find(key);
  return found == config.end() || found->empty();
}

constexpr const char* kGroup = "features";

std::vector<ColumnSpec> feature_columns() {
  std::vector<std::int8_t> values(feature_kinds().size());
  std::iota(values.begin(), values.end(), std::int8_t{0});
  const h5::Type real = h5::Type::float64;
  return {{"x", real, "m", "x of the object's centre in the DEM frame"},
          {"y", real, "m", "y of the object's centre in the DEM frame"},
          {"ground", real, "m", "elevation of the ground under the centre"},
          {"diameter", real, "m", "greatest extent along the ground"},
          {"height", real, "m", "height above the ground, negative for depths"},
          {"yaw", real, "rad", "direction of the greatest extent, counter-clockwise from +x"},
          {"kind", h5::Type::int8, "1", "kind of the object", values, joined(feature_kinds(), " ")},
          {"pattern", h5::Type::int32, "1", "number of the pattern that the object is of, -1 for none"},
          {"number", h5::Type::int64, "1", "number of the object in its pattern or in the list of features"}};
}

/// Some rows, column by column.
struct FeatureColumns {
  std::array<std::vector<double>, 6> reals;  ///< x, y, ground, diameter, height, yaw
  std::vector<std::int8_t> kind;
  std::vector<std::int32_t> pattern;
  std::vector<std::int64_t> number;

  void add(const PlacedFeature& placed) {
    const Feature& feature = placed.feature;
    const FeatureSize size = std::visit([](const auto& shape) { return shape.size(); }, feature.shape);
    const std::array<double, 6> values = {
        feature.x_m,     feature.y_m,   placed.ground_m.value_or(std::numeric_limits<double>::quiet_NaN()),
        size.diameter_m, size.height_m, size.yaw_rad};
    for (std::size_t i = 0; i < reals.size(); ++i) reals[i].push_back(values[i]);
    kind.push_back(static_cast<std::int8_t>(feature.shape.index()));
    pattern.push_back(placed.pattern);
    number.push_back(placed.number);
  }
  [[nodiscard]] std::array<ColumnRows, 9> rows() const {
    return {std::span(reals[0]), std::span(reals[1]), std::span(reals[2]),
            std::span(reals[3]), std::span(reals[4]), std::span(reals[5]),
            std::span(kind),     std::span(pattern),  std::span(number)};
  }
};

}  // namespace

std::optional<double> node_spacing_m(const nlohmann::json& config, double resolution_m) {
  if (!config.is_object()) return resolution_m;
  if (config.contains("mesh")) return std::nullopt;
  const auto is_plane = [](const nlohmann::json& base) {
    return base.is_object() && base.value("type", nlohmann::json()) == "plane";
  };
  const auto base = config.find("base");
  const bool is_flat =
      base != config.end() && (base->is_array() ? std::ranges::all_of(*base, is_plane) : is_plane(*base));
  if (is_flat && is_without(config, "features") && is_without(config, "patterns")) return std::nullopt;
  return resolution_m;
}

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
  hash.update(without_place(raster.crs_wkt)).update(std::as_bytes(std::span(raster.samples.values)));
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

// /features lists the positions and sizes of objects, not all of their parameters: those of listed objects
// are in `config_json`, those of patterns follow from it and the seed. The ground under a centre is
// evaluated in the cell's own coordinates from the origin of the frame, so that a terrain made in parts
// has the same elevations under its features, to the bit.
void write_features(const LandfallFileWriter& file, const std::vector<PlacedFeature>& features) {
  if (features.empty()) return;
  TableWriter table(file.root(), kGroup, feature_columns(), file.compression());
  for (std::size_t begin = 0; begin < features.size(); begin += kTableChunkRows) {
    FeatureColumns columns;
    const std::size_t end = std::min(features.size(), begin + kTableChunkRows);
    for (std::size_t i = begin; i < end; ++i) columns.add(features[i]);
    table.append(columns.rows());
  }
  table.finish();
}

}  // namespace landfall
