// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays become files in memory of the kinds that the tools read, so that the tools need not know of arrays.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "app/python/engine.h"
#include "base/core/error.h"
#include "base/core/hash.h"
#include "base/raster/grid_spec.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "formats/gdal/gdal_loader.h"
#include "store/files/imported_scan.h"
#include "store/files/terrain_file.h"

namespace landfall::python {
namespace {

std::string id_of(std::span<const std::span<const double>> arrays) {
  Hash hash;
  for (const std::span<const double> values : arrays) hash.update(std::as_bytes(values));
  return hash.hex();
}

Provenance provenance_of(const std::string& tool, nlohmann::json config, const std::string& id) {
  Provenance provenance;
  provenance.tool = tool;
  provenance.config = std::move(config);
  provenance.add_input("array", id, nlohmann::json::array());
  return provenance;
}

/// The frame of a site at this place, x and y or longitude and latitude, of a CRS.
std::string site_wkt_of(const std::string& crs, const std::array<double, 2>& center) {
  const MapPoint place{center[0], center[1]};
  PointFrameRequest request{.name = "crs", .crs = {}, .low = place, .high = place, .center = place};
  request.crs.option = crs;
  const PointFrame frame = point_frame(request);
  if (frame.body_fixed)
    throw UsageError("crs: " + crs + " is geocentric; a map or a geographic CRS is expected");
  return frame.crs_wkt;
}

/// Elevations of shape (spec.rows, spec.cols).
void write_array_terrain(const std::string& name, const GridSpec& spec, const double* z,
                         const std::string& crs, const std::array<double, 2>& center) {
  if (!(spec.resolution_m > 0) || !std::isfinite(spec.resolution_m))
    throw UsageError("resolution_m: " + std::to_string(spec.resolution_m) + " is not above 0");
  if (spec.rows < 2 || spec.cols < 2) throw UsageError("z: a terrain needs 2 x 2 elevations");
  Grid<double> nodes(spec);
  const std::span<const double> values{z, nodes.values().size()};
  if (std::ranges::any_of(values, [](double value) { return std::isinf(value); }))
    throw UsageError("z: an elevation is infinite");
  if (std::ranges::all_of(values, [](double value) { return std::isnan(value); }))
    throw UsageError("z: no elevation is a number");
  std::ranges::copy(values, nodes.values().begin());
  const std::array arrays = {values};
  nlohmann::json config = {{"resolution_m", spec.resolution_m}};
  if (!crs.empty()) config.update({{"crs", crs}, {"center", center}});
  const std::string site_wkt = crs.empty() ? kLocalSiteCrsWkt : site_wkt_of(crs, center);
  LandfallFileWriter file({name}, "terrain", provenance_of("terrain-gen", std::move(config), id_of(arrays)));
  write_terrain(file, {std::move(nodes), site_wkt, {}, {}});
}

void write_array_points(const std::string& name, const std::array<std::span<const double>, 3>& xyz) {
  for (const std::span<const double> values : xyz)
    if (const auto bad = std::ranges::find_if_not(values, [](double v) { return std::isfinite(v); });
        bad != values.end())
      throw UsageError("point " + std::to_string(bad - values.begin()) +
                       " has a coordinate that is not finite");
  LandfallFileWriter file({name}, "scan",
                          provenance_of("landfall-import", {{"format", "array"}}, id_of(xyz)));
  ImportedScanWriter writer(file, {}, kLocalSiteCrsWkt);
  ImportedPoints points;
  const auto copy = [](std::span<const double> from, auto& to) { to.assign(from.begin(), from.end()); };
  copy(xyz[0], points.columns.x_est);
  copy(xyz[1], points.columns.y_est);
  copy(xyz[2], points.columns.z_est);
  points.columns.status.assign(xyz[0].size(), PointStatus::returned);
  writer.append(points);
  writer.commit({{}, "array", 0});
}

}  // namespace

bool landfall_write_terrain(const char* name, const double* z, std::int64_t rows, std::int64_t cols,
                            double resolution_m, const char* crs, const double* center) {
  return succeeds([&] {
    const GridSpec spec{resolution_m, -(rows / 2), -(cols / 2), rows, cols};
    write_array_terrain(name, spec, z, crs, {center[0], center[1]});
  });
}

bool landfall_write_points(const char* name, std::size_t count, const double* x, const double* y,
                           const double* z) {
  return succeeds([&] {
    write_array_points(name, {std::span(x, count), std::span(y, count), std::span(z, count)});
  });
}

}  // namespace landfall::python
