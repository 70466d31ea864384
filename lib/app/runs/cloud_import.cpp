// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/cloud_import.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/runs/geodetic_cloud.h"
#include "app/runs/site_points.h"
#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/numerics/non_finite.h"
#include "base/text/joined.h"
#include "chain/terrain/site_wkt.h"
#include "formats/gdal/gdal_loader.h"
#include "formats/mesh/up_axis.h"
#include "formats/points/cloud_box.h"
#include "formats/points/cloud_bytes.h"
#include "formats/points/cloud_units.h"
#include "formats/points/coordinate_steps.h"
#include "formats/points/point_sample.h"
#include "formats/points/screened_cloud.h"
#include "store/files/imported_scan.h"

namespace landfall {
namespace {

constexpr std::size_t kFewestPoints = 64;  // that show a shape
constexpr const char* kBeyondHorizon =
    " points lie beyond the horizon of the site, 90 degrees or more from its centre";

struct CloudExtent {
  CloudBox box{.low = {kInfinity, kInfinity, kInfinity}, .high = {-kInfinity, -kInfinity, -kInfinity}};
  TimeExtent times{.first = kInfinity, .last = -kInfinity};
  PointSample sample;

  [[nodiscard]] std::int64_t count() const { return sample.point_count(); }
};

/// Widens [low, high] to hold the values.
void widen(const std::vector<double>& values, double& low, double& high) {
  double minimum = low;  // a local variable stays in a register
  double greatest = high;
  for (const double value : values) {
    minimum = std::min(minimum, value);
    greatest = std::max(greatest, value);
  }
  low = minimum;
  high = greatest;
}

void add(const CloudBatch& batch, CloudExtent& extent) {
  parallel_for(4, 1, [&](std::size_t part, std::size_t) {
    if (part == 3) return extent.sample.add(batch);
    widen(batch.columns[part], extent.box.low[part], extent.box.high[part]);
  });
  for (const double t : batch[CloudField::t]) {
    if (!std::isfinite(t)) continue;  // SitePoints refuses it
    extent.times.first = std::min(extent.times.first, t);
    extent.times.last = std::max(extent.times.last, t);
  }
}

CloudExtent extent_of(SelectedCloud& cloud, const std::string& name, const ProgressCallback& progress) {
  CloudExtent extent;
  for (CloudBatch batch; cloud.next(batch); report(progress, cloud.progress())) add(batch, extent);
  if (extent.count() > 0) return extent;
  const std::string left_out = joined(cloud.sentences(), "; ");
  throw FormatError(name + ": has no points" + (left_out.empty() ? "" : ": " + left_out));
}

std::string box_finding(const std::string& name, const CloudInfo& info, const CloudExtent& extent) {
  if (!info.box || !info.steps) return "";
  return compare_with_box(name, *info.box, extent.box, *info.steps);
}

/// Warnings about the axis that is up, by the comments of a file and the extent of its points.
std::vector<std::string> place_findings(const CloudImport& import, const CloudInfo& info,
                                        const PointFrame& frame, const PointSample& sample) {
  PlaceComments comments;
  if (!info.steps) {  // not LAS
    const CloudBytes file(import.path);
    const std::vector<std::byte> head = file.up_to(0, kHeadOfComments);
    comments = place_comments({reinterpret_cast<const char*>(head.data()), head.size()});
  }
  std::array<double, 3> extent_m{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] = sample.middle_range(axis);
    extent_m[axis] = (high - low) * (axis == 2 ? frame.metres_per_height : frame.metres_per_unit);
  }
  const bool on_edge =
      frame.metres_per_unit > 0 && sample.size() >= kFewestPoints && stands_on_edge(extent_m);
  return place_warnings(comments, on_edge, import.up_is_given, ": its coordinates are taken as they are");
}

std::string steps_finding(const CloudInfo& info, const PointFrame& frame, const PointSample& sample) {
  const double z_unit = frame.metres_per_unit > 0 ? frame.metres_per_height / frame.metres_per_unit : 0;
  return coarse_steps(sample, z_unit, info.is_float32);
}

/// The unit of the times: that of --time-unit, else that of their column's name if it is one of these.
std::optional<TimeUnit> time_unit_of(const CloudImport& import, const CloudInfo& info) {
  const ColumnUnit& unit = info.units[kTimeField];
  if (import.time_unit || unit.kind != ColumnUnit::Kind::time) return import.time_unit;
  for (const TimeUnit known : {TimeUnit::s, TimeUnit::ms, TimeUnit::us, TimeUnit::ns})
    if (std::abs(unit.factor * per_second(known) - 1) < 1e-9) return known;
  return std::nullopt;
}

/// The scale of the times of a file, of which some are finite; an unused one without times.
TimeScale times_of(const CloudImport& import, const CloudInfo& info, std::optional<TimeUnit> unit,
                   const CloudExtent& extent) {
  const bool has_times = info.has(CloudField::t);
  if (import.time_unit && info.steps)  // LAS
    throw UsageError("--time-unit is for text, PLY and PCD; " + import.path +
                     " is LAS, whose times are in seconds");
  if (import.time_unit && !has_times)
    throw UsageError("--time-unit: " + import.path +
                     " has no times: leave the option out, or name their column with --columns t=...");
  if (!has_times || extent.times.first > extent.times.last) return {};
  return time_scale(import.path, info, unit, extent.times);
}

bool has_crs(const CloudImport& import, const CloudInfo& info) {
  return !import.crs.empty() || !info.crs_wkt.empty() || info.geo_keys.has_value();
}

std::optional<StatedMapUnit> stated_unit(const CloudInfo& info) {
  const ColumnUnit& x = info.units[0];
  const ColumnUnit& y = info.units[1];
  if (x.kind == ColumnUnit::Kind::angle) return StatedMapUnit{.is_angle = true, .text = x.text};
  if (x.kind != ColumnUnit::Kind::length || y.kind != ColumnUnit::Kind::length) return std::nullopt;
  return StatedMapUnit{.metres = {x.factor, y.factor},
                       .text = x.text == y.text ? x.text : x.text + " and " + y.text};
}

PointFrame frame_of(const CloudImport& import, const CloudInfo& info, const CloudExtent& extent,
                    const std::optional<GeodeticExtent>& across_seam, bool is_geodetic) {
  PointFrameRequest request{.name = import.path,
                            .crs = {},
                            .low = {extent.box.low[0], extent.box.low[1]},
                            .high = {extent.box.high[0], extent.box.high[1]},
                            .center = {},
                            .vertical_scale = import.vertical_scale,
                            .across_seam = across_seam,
                            .is_geodetic = is_geodetic};
  request.crs.option = import.crs;
  request.crs.wkt = info.crs_wkt;
  if (info.geo_keys) {
    request.crs.key_directory = info.geo_keys->directory;
    request.crs.key_numbers = info.geo_keys->numbers;
    request.crs.key_texts = info.geo_keys->texts;
  }
  request.stated = stated_unit(info);
  if (!request.vertical_scale && info.units[2].kind == ColumnUnit::Kind::length) request.vertical_scale = 1;
  if (import.center.size() >= 2) request.center = MapPoint{import.center[0], import.center[1]};
  return point_frame(request);
}

/// The extent of points on both sides of the seam of their CRS; none of others.
std::optional<GeodeticExtent> extent_across_seam(SelectedCloud& cloud, const PointFrame& frame) {
  GeodeticExtentSearch search;
  for (CloudBatch batch; cloud.next(batch);)
    for (std::size_t i = 0; i < batch.size(); ++i)
      search.add(frame.lon_lat({batch.columns[0][i], batch.columns[1][i]}));
  return search.across_seam();
}

/// The frame of the points, and their extent, which becomes that of their longitudes, latitudes and heights
/// if they are body-fixed.
PointFrame place_cloud(const CloudImport& import, const CloudInfo& info, SelectedCloud& cloud,
                       CloudExtent& extent, const ProgressCallback& progress) {
  PointFrame frame = frame_of(import, info, extent, {}, false);
  const bool is_geodetic = frame.body_fixed.has_value();
  if (is_geodetic) {
    cloud.convert([&](auto source) { return geodetic_cloud(std::move(source), *frame.body_fixed); });
    cloud.rewind();
    extent = extent_of(cloud, import.path, progress);
    frame = frame_of(import, info, extent, {}, true);
  }
  if (!frame.lon_lat) return frame;
  cloud.rewind();
  const auto across = extent_across_seam(cloud, frame);
  return across ? frame_of(import, info, extent, across, is_geodetic) : frame;
}

/// The numbers of points that the first pass left out, without the file's name.
std::vector<std::string> left_out_sentences(const SelectedCloud& cloud, const ScreenedCloud& source,
                                            const CloudNodata& nodata) {
  std::vector<std::string> sentences = cloud.sentences();
  if (!nodata.z.empty())
    sentences.push_back(grouped(source.left_out()) + " points with a z of --nodata are left out");
  return sentences;
}

nlohmann::json config_of(const CloudImport& import, const CloudInfo& info, const PointFrame& frame,
                         const std::array<double, 3>& center) {
  nlohmann::json config = {
      {"source", std::filesystem::path(import.path).filename().string()},
      {"format", info.format},
      {"center", center},
      {"crs", frame.crs_name.empty() ? nlohmann::json() : nlohmann::json(frame.crs_name)},
      {"vertical_scale", frame.metres_per_height}};
  if (!import.columns.empty()) config["columns"] = import.columns;
  if (import.selection.keep_noise) config["keep_noise"] = true;
  if (import.selection.returns != ReturnChoice::all)
    config["returns"] = import.selection.returns == ReturnChoice::first ? "first" : "last";
  if (import.axes.latitude_first) config["axis_order"] = "yx";
  if (import.axes.y_up) config["up"] = "y";
  if (import.time_unit) config["time_unit"] = name_of(*import.time_unit);
  if (import.nodata.keeps_undeclared_fills) config["nodata"] = "none";
  if (!import.nodata.z.empty()) config["nodata"] = import.nodata.z;
  return config;
}

/// The sentences about a file that are not empty, which begin with its name.
std::vector<std::string> named(const std::string& name,
                               std::initializer_list<std::vector<std::string>> lists) {
  std::vector<std::string> warnings;
  for (const auto& list : lists)
    for (const std::string& sentence : list)
      if (!sentence.empty()) warnings.push_back(name + ": " + sentence);
  return warnings;
}

void add_bounds(const PointColumns& points, std::array<std::array<double, 2>, 3>& bounds) {
  const std::array columns = {&points.x_est, &points.y_est, &points.z_est};
  for (std::size_t axis = 0; axis < 3; ++axis) widen(*columns[axis], bounds[axis][0], bounds[axis][1]);
}

/// Which columns an import has, and what its times count.
ImportedColumns columns_of(const CloudInfo& info, const TimeScale& times) {
  ImportedColumns columns{.t = info.has(CloudField::t), .clock = times.clock};
  for (const CloudField field : {CloudField::intensity, CloudField::return_number, CloudField::pulse,
                                 CloudField::pixel, CloudField::echo_width})
    if (info.has(field)) columns.of_points.emplace_back(name_of(field));
  return columns;
}

}  // namespace

ImportedCloud import_cloud(const CloudImport& import, ImportOutput output) {
  auto screened = std::make_unique<ScreenedCloud>(open_cloud(import.path, column_choice(import.columns)),
                                                  import.path, import.nodata);
  const ScreenedCloud& source = *screened;
  CloudInfo info = source.info();
  const std::optional<TimeUnit> time_unit = time_unit_of(import, info);
  UnitConversion conversion = unit_conversion(info, has_crs(import, info), import.vertical_scale);
  if (time_unit) conversion.factors[kTimeField] = 1;  // TimeScale converts them
  SelectedCloud cloud(converted(std::move(screened), conversion), import.path, import.selection, import.axes);
  info = cloud.info();
  info.notes.insert(info.notes.end(), conversion.notes.begin(), conversion.notes.end());
  CloudExtent extent;
  output.phase("measure",
               [&](const ProgressCallback& progress) { extent = extent_of(cloud, import.path, progress); });
  const std::string box_warning = box_finding(import.path, info, extent);
  const std::vector<std::string> left_out = left_out_sentences(cloud, source, import.nodata);
  const LeftOut counts = cloud.left_out();
  PointFrame frame;
  output.phase("place", [&](const ProgressCallback& progress) {
    frame = place_cloud(import, info, cloud, extent, progress);
  });
  const TimeScale times = times_of(import, info, time_unit, extent);
  ImportedCloud result{
      .point_count = extent.count(),
      .center = {frame.center.x, frame.center.y, import.center.size() > 2 ? import.center[2] : 0},
      .bounds_m = {},
      .format = info.format,
      .crs_name = frame.crs_name,
      .left_out = counts};
  result.bounds_m.fill({kInfinity, -kInfinity});
  output.provenance.config = config_of(import, info, frame, result.center);
  std::vector<std::string> assumed = info.notes;
  assumed.insert(assumed.end(), frame.assumed.begin(), frame.assumed.end());
  result.warnings =
      named(import.path, {assumed,
                          left_out,
                          {times.warning, box_warning, steps_finding(info, frame, extent.sample)},
                          place_findings(import, info, frame, extent.sample)});
  cloud.rewind();
  output.phase("identify", [&](const ProgressCallback&) {
    output.provenance.add_input("points", content_id(import.path), nlohmann::json::array(),
                                std::move(assumed));
  });
  LandfallFileWriter file(output.file, "scan", output.provenance);
  ImportedScanWriter writer(file, columns_of(info, times),
                            raised(frame.crs_wkt, result.center[2] * frame.metres_per_height));
  output.phase("write", [&](const ProgressCallback& progress) {
    const SitePoints site(frame, result.center[2], times, import.path);
    ImportedPoints points;
    std::int64_t count = 0;
    std::int64_t beyond = 0;
    for (CloudBatch batch; cloud.next(batch); report(progress, cloud.progress())) {
      beyond += site.convert(batch, points);
      count += static_cast<std::int64_t>(points.columns.size());
      add_bounds(points.columns, result.bounds_m);
      writer.append(points);
    }
    if (count + beyond != extent.count()) throw FormatError(import.path + ": changed while it was read");
    if (count == 0)
      throw FormatError(import.path + ": all " + grouped(beyond) + kBeyondHorizon +
                        "; give a --center among its points");
    if (beyond > 0)
      result.warnings.push_back(import.path + ": " + grouped(beyond) + " of " + grouped(extent.count()) +
                                kBeyondHorizon + " and are left out");
    result.point_count = count;
    const double first_t_s = times.seconds(extent.times.first);
    writer.commit({result.center, info.format, std::isfinite(first_t_s) ? first_t_s : 0});
  });
  return result;
}

}  // namespace landfall
