// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/text/number_text.h"
#include "store/files/grid_file.h"
#include "store/files/terrain_file.h"

namespace landfall {
namespace {

/// An open file and its grid.
struct LayerFile {
  LandfallFileReader file;
  GridLayerReader layers;

  explicit LayerFile(LandfallFileReader opened) : file(std::move(opened)), layers(file) {}
};

using Range = std::array<double, 2>;

/// The bounds of all elevations, from strips of tiles.
Range range_of_tiles(const LayerFile& source, const ProgressCallback& progress) {
  const GridSpec& spec = source.layers.spec();
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::int64_t row = 0; row < spec.rows; row += source.layers.tile().row) {
    const GridSpec strip =
        part_of(spec, {row, 0}, std::min(source.layers.tile().row, spec.rows - row), spec.cols);
    const Grid<double> nodes = source.layers.read_window<double>("z", strip);
    for (const double z : nodes.values()) {
      if (z < range[0]) range[0] = z;
      if (z > range[1]) range[1] = z;
    }
    report(progress, static_cast<double>(row + strip.rows) / static_cast<double>(spec.rows));
  }
  return range;
}

Range elevation_range(const LayerFile& source, const ProgressCallback& progress) {
  const std::optional<Range> stated = source.layers.range("z");
  const Range range = stated ? *stated : range_of_tiles(source, progress);
  if (std::isinf(range[0]) && range[0] > 0 && std::isinf(range[1]) && range[1] < 0)
    source.file.fail("/z has no finite node");
  if (!std::isfinite(range[0]) || !std::isfinite(range[1]))
    source.file.fail(stated ? "/z: actual_range is not finite" : "/z holds an infinite elevation");
  if (range[0] > range[1]) source.file.fail("/z: actual_range is empty");
  return range;
}

Grid<double> checked_window(const LayerFile& source, const Range& range, const GridSpec& window) {
  Grid<double> nodes = source.layers.read_window<double>("z", window);
  const auto values = std::as_const(nodes).values();
  const bool wrong =
      std::any_of(values.begin(), values.end(), [&](double z) { return z < range[0] || z > range[1]; });
  if (wrong) source.file.fail("/z holds an elevation outside its actual_range");
  return nodes;
}

/// "[3, 17]": a node of a window by its row and column in the whole grid.
std::string place_in(const GridSpec& whole, const GridSpec& window, std::size_t i) {
  const auto cols = static_cast<std::size_t>(window.cols);
  const std::int64_t row = window.first_row - whole.first_row + static_cast<std::int64_t>(i / cols);
  const std::int64_t col = window.first_col - whole.first_col + static_cast<std::int64_t>(i % cols);
  return "[" + std::to_string(row) + ", " + std::to_string(col) + "]";
}

Grid<float> checked_albedo(const LayerFile& source, const GridSpec& window) {
  Grid<float> albedo = source.layers.read_window<float>("albedo", window);
  const Grid<double> nodes = source.layers.read_window<double>("z", window);
  for (std::size_t i = 0; i < window.size(); ++i) {
    const float value = albedo.values()[i];
    if (std::isfinite(nodes.values()[i]) && !(value >= 0 && value <= 1))
      source.file.fail("/albedo" + place_in(source.layers.spec(), window, i) + " = " + number_text(value) +
                       " is not in [0, 1]");
  }
  return albedo;
}

}  // namespace

std::unique_ptr<const AlbedoMap> open_albedo(const std::filesystem::path& path) {
  LandfallFileReader file(path, {"terrain"});
  if (!h5::exists(file.root(), "albedo"))
    file.fail("has no layer /albedo, which /surface/albedo \"terrain\" asks for");
  const auto source = std::make_shared<const LayerFile>(std::move(file));
  return std::make_unique<const AlbedoMap>(
      source->layers.spec(), source->layers.tile(),
      [source](const GridSpec& window) { return checked_albedo(*source, window); });
}

std::optional<LargeTerrainInput> open_large_terrain(const std::filesystem::path& path, std::int64_t max_nodes,
                                                    const ProgressCallback& progress) {
  LandfallFileReader file(path, {"terrain"});
  if (!h5::exists(file.root(), "z")) return std::nullopt;
  const auto source = std::make_shared<const LayerFile>(std::move(file));
  const GridSpec& spec = source->layers.spec();
  const bool fits = spec.rows <= max_nodes / spec.cols;
  if (fits || spec.rows < 2 || spec.cols < 2 || !CellOrigin::has_windows(spec)) return std::nullopt;
  const Range range = elevation_range(*source, progress);
  const auto load = [source, range](const GridSpec& window) {
    return checked_window(*source, range, window);
  };
  return LargeTerrainInput{{source->layers.crs_wkt(), source->file.file_id(), source->file.chain(),
                            node_spacing_m(source->file.config(), spec.resolution_m)},
                           {spec, range[0], range[1], source->layers.tile(), load}};
}

}  // namespace landfall
