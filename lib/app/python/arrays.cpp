// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays become files in memory of the kinds that the tools read, so that the tools need not know of arrays.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <span>

#include "app/python/module.h"
#include "base/core/error.h"
#include "base/core/hash.h"
#include "base/raster/grid_spec.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "formats/gdal/gdal_loader.h"
#include "store/files/imported_scan.h"
#include "store/files/terrain_file.h"

namespace landfall::python {
namespace {

namespace py = pybind11;
using Numbers = py::array_t<double, py::array::c_style>;

std::span<const double> values_of(const Numbers& numbers) {
  return {numbers.data(), static_cast<std::size_t>(numbers.size())};
}

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

/// The terrain of an array (rows, columns), south to north; its node at half of its rows and columns is the
/// origin, at `center` of the CRS if there is one.
void write_array_terrain(const std::string& name, const Numbers& z, double resolution_m,
                         const std::string& crs, const std::array<double, 2>& center) {
  if (!(resolution_m > 0) || !std::isfinite(resolution_m))
    throw UsageError("resolution_m: " + std::to_string(resolution_m) + " is not above 0");
  const std::int64_t rows = z.shape(0), cols = z.shape(1);
  if (rows < 2 || cols < 2) throw UsageError("z: a terrain needs 2 x 2 elevations");
  const GridSpec spec{resolution_m, -(rows / 2), -(cols / 2), rows, cols};
  const std::span<const double> values = values_of(z);
  if (std::ranges::any_of(values, [](double value) { return std::isinf(value); }))
    throw UsageError("z: an elevation is infinite");
  if (std::ranges::all_of(values, [](double value) { return std::isnan(value); }))
    throw UsageError("z: no elevation is a number");
  Grid<double> nodes(spec);
  std::ranges::copy(values, nodes.values().begin());
  const std::array arrays = {values};
  nlohmann::json config = {{"resolution_m", resolution_m}};
  if (!crs.empty()) config.update({{"crs", crs}, {"center", center}});
  const std::string site_wkt = crs.empty() ? kLocalSiteCrsWkt : site_wkt_of(crs, center);
  LandfallFileWriter file({name}, "terrain", provenance_of("terrain-gen", std::move(config), id_of(arrays)));
  write_terrain(file, {std::move(nodes), site_wkt, {}, {}});
}

/// Points without a lidar, as landfall-import writes them.
void write_array_points(const std::string& name, const Numbers& x, const Numbers& y, const Numbers& z) {
  const std::array arrays = {values_of(x), values_of(y), values_of(z)};
  for (const std::span<const double> values : arrays)
    if (const auto bad = std::ranges::find_if_not(values, [](double v) { return std::isfinite(v); });
        bad != values.end())
      throw UsageError("point " + std::to_string(bad - values.begin()) +
                       " has a coordinate that is not finite");
  LandfallFileWriter file({name}, "scan",
                          provenance_of("landfall-import", {{"format", "array"}}, id_of(arrays)));
  ImportedScanWriter writer(file, {}, kLocalSiteCrsWkt);
  ImportedPoints points;
  const auto copy = [](std::span<const double> from, auto& to) { to.assign(from.begin(), from.end()); };
  copy(arrays[0], points.columns.x_est);
  copy(arrays[1], points.columns.y_est);
  copy(arrays[2], points.columns.z_est);
  points.columns.status.assign(arrays[0].size(), PointStatus::returned);
  writer.append(points);
  writer.commit({{}, "array", 0});
}

}  // namespace

void bind_arrays(py::module_& module) {
  module.def("write_terrain", write_array_terrain, py::call_guard<py::gil_scoped_release>());
  module.def("write_points", write_array_points, py::call_guard<py::gil_scoped_release>());
}

}  // namespace landfall::python
