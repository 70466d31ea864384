// SPDX-License-Identifier: GPL-3.0-or-later
// Landing sites become a GeoPackage, not GeoJSON. RFC 7946 allows longitude and latitude on WGS 84 only: a
// site on another body or in a local frame has none, and metres in a GeoJSON file would be shown as
// degrees off the coast of Africa. A GeoPackage holds any frame, and GDAL makes GeoJSON of it where that
// has a meaning. Its time of change is always 1970-01-01, so that equal sites give equal bytes.
#include "app/exports/sites.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "formats/gdal/gdal_loader.h"
#include "store/files/contents.h"
#include "store/files/grid_file.h"

namespace landfall {
namespace {

constexpr std::size_t kSitesPerPiece = 8192;  // in memory at a time

}  // namespace

void write_sites_csv(const LandfallFileReader& hazards, ByteSink& sink) {
  const TableReader sites(hazards.root(), "sites", hazards.name());
  const std::vector<ContentInfo> columns = site_columns_of(sites);
  sink.write(joined(columns, ",", name_with_unit) + "\n");
  const std::size_t rows = columns.empty() ? 0 : sites.row_count(columns.front().name);
  std::vector<std::vector<double>> values(columns.size());
  for (std::size_t first = 0; first < rows; first += kSitesPerPiece) {
    const std::size_t count = std::min(rows - first, kSitesPerPiece);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      values[c].resize(count);
      sites.read(columns[c].name, first, std::span(values[c]));
    }
    std::string lines;
    for (std::size_t row = 0; row < count; ++row) {
      for (std::size_t c = 0; c < columns.size(); ++c) {
        if (c > 0) lines += ',';
        if (columns[c].type == h5::Type::float32)  // the shortest text for the float32
          append_number(lines, static_cast<float>(values[c][row]));
        else
          append_number(lines, values[c][row]);
      }
      lines += '\n';
    }
    sink.write(lines);
  }
}

void write_sites_geopackage(const LandfallFileReader& hazards, const OutputOptions& output) {
  const TableReader sites(hazards.root(), "sites", hazards.name());
  PointLayer layer;
  layer.name = "sites";
  layer.crs_wkt = GridLayerReader(hazards).crs_wkt();
  for (const ContentInfo& column : site_columns_of(sites)) {
    std::vector<double> values(sites.row_count(column.name));
    sites.read(column.name, 0, std::span(values));
    if (column.name == "x")
      layer.x_m = std::move(values);
    else if (column.name == "y")
      layer.y_m = std::move(values);
    else if (column.name == "z")
      layer.z_m = std::move(values);
    else
      layer.columns.push_back({name_with_unit(column), std::move(values),
                               column.type != h5::Type::float32 && column.type != h5::Type::float64});
  }
  if (layer.x_m.empty() && layer.columns.empty()) hazards.fail("has no sites");
  const auto is_short = [&](const auto& values) { return values.size() != layer.x_m.size(); };
  if (is_short(layer.y_m) || is_short(layer.z_m) ||
      std::ranges::any_of(layer.columns, [&](const PointLayer::Column& c) { return is_short(c.values); }))
    hazards.fail("has sites whose columns differ in length");
  write_geopackage(output, layer);
}

}  // namespace landfall
