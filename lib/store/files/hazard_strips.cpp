// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/hazard_strips.h"

#include <algorithm>
#include <utility>

#include "base/core/error.h"
#include "base/raster/grid.h"
#include "base/text/joined.h"
#include "store/files/contents.h"
#include "store/files/hazard_file.h"

namespace landfall {
namespace {

constexpr std::int64_t kStripRows = 512;  // a multiple of the rows of a tile

}  // namespace

const std::vector<std::string>& strip_layer_names() {
  static const std::vector<std::string> names = {"slope", "roughness", "safe"};
  return names;
}

void check_strip_layers(const std::vector<std::string>& layers) {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const auto before = layers.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(layers.begin(), before, layers[i]) != before)
      throw UsageError("--layers: '" + layers[i] + "' is given twice");
    if (!std::ranges::count(strip_layer_names(), layers[i]))
      throw UsageError("--layers: '" + layers[i] + "' is not a layer that can be written alone; these are " +
                       joined(strip_layer_names()));
  }
}

HazardStripReader::HazardStripReader(const std::filesystem::path& path)
    : file_(path, {"dem", "terrain"}),
      layers_((require_gridded(file_), file_)),
      kind_(kind_of(file_)),
      layer_(kind_ == "dem" ? "z_est" : "z") {}

bool HazardStripReader::has_sigma() const { return kind_ == "dem" && layers_.has("z_sigma_rel"); }

StripSource HazardStripReader::source() {
  return {layers_.spec(), kStripRows, [this](const GridSpec& rows) { return load(rows); }};
}

const Grid<double>& HazardStripReader::tile_row(std::int64_t number) {
  const auto found = tile_rows_.find(number);
  if (found != tile_rows_.end()) return found->second;
  const GridSpec& map = layers_.spec();
  const std::int64_t first = number * layers_.tile().row;
  const GridSpec part = part_of(map, {first, 0}, std::min(layers_.tile().row, map.rows - first), map.cols);
  Grid<double> rows = layers_.read_checked_rows(layer_, LayerValues::finite, part);
  return tile_rows_.emplace(number, std::move(rows)).first->second;
}

Grid<double> HazardStripReader::load(const GridSpec& rows) {
  const std::int64_t tile = layers_.tile().row;
  const std::int64_t first = rows.first_row - layers_.spec().first_row;
  const std::int64_t from = first / tile;
  const std::int64_t last = (first + rows.rows - 1) / tile;
  std::erase_if(tile_rows_, [&](const auto& kept) { return kept.first < from || kept.first > last; });
  auto result = Grid<double>::unset(rows);
  for (std::int64_t number = from; number <= last; ++number) {
    const Grid<double>& kept = tile_row(number);
    const std::int64_t begin = std::max(number * tile, first);
    const std::int64_t end = std::min(number * tile + kept.spec().rows, first + rows.rows);
    for (std::int64_t row = begin; row < end; ++row)
      std::ranges::copy(kept.row(row - number * tile), result.row(row - first).begin());
  }
  return result;
}

HazardStripWriter::HazardStripWriter(LandfallFileWriter& file, const GridSpec& spec,
                                     const std::string& crs_wkt, std::vector<std::string> layers)
    : file_(file), out_(file, spec, crs_wkt), names_(std::move(layers)) {
  const std::string safe = has("safe") ? "safe" : "";
  for (const char* const name : {"slope", "roughness"})
    if (has(name)) layers_.emplace(name, Layer{out_.begin<float>(name, {.ancillary_variables = safe}), {}});
}

bool HazardStripWriter::has(const std::string& name) const {
  return std::ranges::find(names_, name) != names_.end();
}

void HazardStripWriter::take(const std::string& name, const Grid<double>& values) {
  const auto layer = layers_.find(name);
  if (layer == layers_.end()) return;
  const Grid<float> rounded = single_precision(values);
  out_.write_rows(layer->second.dataset, name, rounded);
  layer->second.range.add(rounded.values());
}

void HazardStripWriter::take(const PlaceMeasures& strip) {
  take("slope", strip.slope_deg);
  take("roughness", strip.roughness_m);
}

void HazardStripWriter::finish(const HazardMap& map) {
  for (const auto& [name, layer] : layers_) GridLayerWriter::write_range<float>(layer.dataset, layer.range);
  if (has("safe")) out_.write("safe", map.safe);
  write_sites(file_, map);
  file_.commit();
}

}  // namespace landfall
