// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D295
//
// Pictures show the maximum flag of a pixel, and limit the colour range only if outliers more than double
// it. Classes: D293, D295.
#include "app/exports/quick_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "app/exports/grid_layers.h"
#include "app/exports/point_reader.h"
#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/dictionary/layers.h"
#include "base/returns/columns.h"
#include "store/files/evaluation_file.h"
#include "store/files/terrain_file.h"

namespace landfall {
namespace {

constexpr const char* kXEst = name_of(&PointColumns::x_est);
constexpr const char* kYEst = name_of(&PointColumns::y_est);
constexpr std::int64_t kMaxPixels = 1100;
constexpr std::int64_t kMeshPixels = 500;  ///< each needs a search in the mesh

struct PlaceValue {
  std::int8_t value;
  MapClass drawn;
};

/// The classes of a layer of a hazard map, from the best to the worst; other layers have none.
std::vector<PlaceValue> classes_of(const GridSource& grid, const ContentInfo& layer) {
  if (grid.kind() != "hazards" || layer.type != h5::Type::int8) return {};
  std::vector<PlaceValue> found;
  for (const auto& c : dictionary::place_classes(layer.name == "safe_true" ? "safe" : layer.name))
    found.insert(found.begin(), {static_cast<std::int8_t>(c.value), {c.name, c.color}});
  return found;
}

RgbImage class_picture(const GridSource& grid, const ContentInfo& layer,
                       const std::vector<PlaceValue>& classes, const ProgressCallback& progress) {
  // Bins get the rank of their class, so that the greatest of a pixel is the worst; 0 for no class.
  std::array<std::int8_t, 256> ranks{};
  MapStyle style{layer.name, ""};
  for (const PlaceValue& c : classes) {
    style.classes.push_back(c.drawn);
    ranks.at(static_cast<std::uint8_t>(c.value)) = static_cast<std::int8_t>(style.classes.size());
  }
  auto bins = std::get<Grid<std::int8_t>>(grid.read(layer, progress));
  for (std::int8_t& bin : bins.values()) bin = ranks.at(static_cast<std::uint8_t>(bin));
  PixelMap map = reduce(bins, Reduction::greatest, kMaxPixels);
  for (double& value : map.values) value = value > 0 ? value - 1 : std::numeric_limits<double>::quiet_NaN();
  if (map.pixel_m > grid.spec().resolution_m) style.title += ", the worst class of a pixel";
  return map_picture(map, style);
}

RgbImage grid_picture(const GridSource& grid, const ContentInfo& layer, const ProgressCallback& progress) {
  const std::vector<PlaceValue> classes = classes_of(grid, layer);
  if (!classes.empty()) return class_picture(grid, layer, classes, progress);
  const Reduction reduction = is_class(layer) ? Reduction::greatest : Reduction::mean;
  LayerReducer reducer(grid.spec(), reduction, kMaxPixels);
  grid.read_strips(
      layer,
      [&reducer](const AnyGrid& strip) {
        std::visit([&reducer](const auto& rows) { reducer.add(rows); }, strip);
      },
      progress);
  MapStyle style = style_of(grid.kind(), layer);
  if (grid.kind() == "evaluation") style.limit = stored_limit(grid.file(), layer.name);
  return map_picture(reducer.map(), style);
}

struct ScanExtent {
  PointMap::Box box{1, -1, 1, -1};  ///< empty
  std::size_t count = 0;

  [[nodiscard]] bool holds(double x, double y) const {
    return x >= box.west_m && x <= box.east_m && y >= box.south_m && y <= box.north_m;
  }
  void add(double x, double y) {
    box = count++ == 0 ? PointMap::Box{x, x, y, y}
                       : PointMap::Box{std::min(box.west_m, x), std::max(box.east_m, x),
                                       std::min(box.south_m, y), std::max(box.north_m, y)};
  }
};

/// The extent of the estimated positions of the returns. False returns, which may lie far off, count only if
/// there are no others. Throws FormatError if there is no return at all.
ScanExtent scan_extent_of(const PointReader& points, const ProgressCallback& progress) {
  ScanExtent of_true;
  ScanExtent of_all;
  points.read(
      {{kXEst, kYEst, name_of(&PointColumns::status)}, {true, 1}, 2},
      [&](const PointBatch& batch) {
        for (const std::uint32_t i : batch.selected) {
          of_all.add(batch.real(0)[i], batch.real(1)[i]);
          if (batch.number(2, i) == static_cast<double>(PointStatus::returned))
            of_true.add(batch.real(0)[i], batch.real(1)[i]);
        }
      },
      progress);
  if (of_all.count == 0) points.file().fail("holds no return");
  return of_true.count > 0 ? of_true : of_all;
}

RgbImage scan_picture(const PointReader& points, const std::string& layer, const ProgressCallback& progress) {
  const ScanExtent extent = scan_extent_of(points, [&](double f) { report(progress, f / 3); });
  const bool counts = layer == "count";
  const bool flags = !counts && is_class(points.column(layer));
  PointMap map(extent.box, extent.count, kMaxPixels, flags ? Reduction::greatest : Reduction::mean);
  PointReader::Pass pass{{kXEst, kYEst}, {true, 1}, 2};
  if (!counts) pass.columns.push_back(layer);
  points.read(
      pass,
      [&](const PointBatch& batch) {
        for (const std::uint32_t i : batch.selected)
          if (extent.holds(batch.real(0)[i], batch.real(1)[i]))
            map.add(batch.real(0)[i], batch.real(1)[i], counts ? 1 : batch.number(2, i));
      },
      [&](double f) { report(progress, (1 + 2 * f) / 3); });
  if (counts) return map_picture(map.count(), {"returns per pixel", "1", Colors::count});
  MapStyle style = style_of("dem", points.column(layer));  // whose layers have the same names
  style.title += flags ? ", the greatest of the returns" : ", mean of the returns";
  style.cut = !flags;  // false returns lie far from the ground
  return map_picture(map.values(), style);
}

RgbImage mesh_picture(const TriangleMesh& mesh, const ProgressCallback& progress) {
  ScanExtent extent;
  for (const auto& vertex : mesh.data().vertices) extent.add(vertex.x(), vertex.y());
  const double width = extent.box.east_m - extent.box.west_m;
  const double height = extent.box.north_m - extent.box.south_m;
  PixelMap map;
  map.pixel_m = std::max(width, height) / static_cast<double>(kMeshPixels);
  if (!(map.pixel_m > 0)) map.pixel_m = 1;  // no horizontal extent
  const auto pixels = [&map](double extent_m) {
    return std::clamp<std::int64_t>(std::llround(std::ceil(extent_m / map.pixel_m)), 1, kMeshPixels);
  };
  map.rows = pixels(height);
  map.cols = pixels(width);
  map.west_m = extent.box.west_m;
  map.north_m = extent.box.north_m;
  map.values.resize(static_cast<std::size_t>(map.rows * map.cols));
  parallel_for(
      map.values.size(), 1000,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t row = i / static_cast<std::size_t>(map.cols);
          const std::size_t col = i % static_cast<std::size_t>(map.cols);
          map.values[i] = mesh.elevation(map.west_m + (static_cast<double>(col) + 0.5) * map.pixel_m,
                                         map.north_m - (static_cast<double>(row) + 0.5) * map.pixel_m);
        }
      },
      progress);
  return map_picture(map, style_of("terrain", {"z", h5::Type::float64, "m", ""}));
}

RgbImage mesh_file_picture(const std::filesystem::path& input, const std::string& layer,
                           const ProgressCallback& progress) {
  if (!layer.empty() && layer != "z")
    throw UsageError(input.string() + ": no layer '" + layer + "'; a mesh terrain has z");
  const TerrainInput terrain = read_terrain(input, [&](double f) { report(progress, f / 2); });
  return mesh_picture(*terrain.mesh, [&](double f) { report(progress, (1 + f) / 2); });
}

}  // namespace

MapStyle style_of(const std::string& kind, const ContentInfo& content) {
  MapStyle style{content.name, content.units};
  const dictionary::Layer* const words = dictionary::find_layer(kind, content.name);
  const std::string_view drawn_as = words == nullptr ? "" : words->style;
  style.relief = drawn_as == "elevation";
  if (style.relief) style.colors = Colors::elevation;
  if (drawn_as == "count") style.colors = Colors::count;
  if (drawn_as == "signed") {
    style.colors = Colors::error;
    style.title += std::string(", ") + words->long_name;
  }
  style.from_zero = drawn_as == "magnitude";
  style.cut = !style.relief && !is_class(content);
  return style;
}

RgbImage quick_look(const std::filesystem::path& input, const std::string& layer,
                    const ProgressCallback& progress) {
  bool is_mesh = false;
  {
    const LandfallFileReader file(input, kLandfallKinds);
    if (kind_of(file) == "scan") {
      const PointReader points(input);
      return scan_picture(points, layer.empty() ? name_of(&PointColumns::z_est) : layer, progress);
    }
    is_mesh = kind_of(file) == "terrain" && !has_grid(file);
  }
  if (is_mesh) return mesh_file_picture(input, layer, progress);
  const GridSource grid(input);
  std::vector<std::string> names;
  if (!layer.empty()) names.push_back(layer);
  return grid_picture(grid, grid.choose(names).front(), progress);
}

}  // namespace landfall
