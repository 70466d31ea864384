// SPDX-License-Identifier: GPL-3.0-or-later
#include "runs/cloud_import.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/number_text.h"
#include "base/parallel.h"
#include "files/imported_scan.h"
#include "imports/cloud_reader.h"
#include "terrain/gdal/gdal_loader.h"
#include "terrain/site_wkt.h"

namespace landfall {
namespace {

constexpr std::size_t kPointsPerPiece = 1U << 14U;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct Extent {
  std::array<double, 3> low{kInfinite, kInfinite, kInfinite};
  std::array<double, 3> high{-kInfinite, -kInfinite, -kInfinite};
  double first_t_s = kInfinite;
  std::int64_t count = 0;
  std::int64_t not_finite = 0;
  std::int64_t withheld = 0;
};

bool is_finite_point(const CloudBatch& batch, std::size_t i) {
  return std::isfinite(batch.columns[0][i]) && std::isfinite(batch.columns[1][i]) &&
         std::isfinite(batch.columns[2][i]);
}

bool is_withheld(const CloudBatch& batch, std::size_t i) {
  const std::vector<double>& classes = batch[CloudField::classification];
  return !classes.empty() && classes[i] == kWithheld;
}

void add(const CloudBatch& batch, Extent& extent) {
  const std::vector<double>& t = batch[CloudField::t];
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (!is_finite_point(batch, i)) {
      ++extent.not_finite;
      continue;
    }
    if (is_withheld(batch, i)) {
      ++extent.withheld;
      continue;
    }
    ++extent.count;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      extent.low[axis] = std::min(extent.low[axis], batch.columns[axis][i]);
      extent.high[axis] = std::max(extent.high[axis], batch.columns[axis][i]);
    }
    if (!t.empty()) extent.first_t_s = std::min(extent.first_t_s, t[i]);
  }
}

Extent extent_of(CloudReader& cloud, const std::string& name, const ProgressCallback& progress) {
  Extent extent;
  for (CloudBatch batch; cloud.next(batch); report(progress, cloud.progress())) add(batch, extent);
  cloud.rewind();
  if (extent.count == 0)
    throw FormatError(name + ": has no points" +
                      (extent.not_finite + extent.withheld > 0
                           ? " but " + grouped(extent.not_finite) + " without a position and " +
                                 grouped(extent.withheld) + " withheld ones"
                           : ""));
  return extent;
}

PointFrame frame_of(const CloudImport& import, const CloudInfo& info, const Extent& extent) {
  PointFrameRequest request{.name = import.path,
                            .crs = {},
                            .low = {extent.low[0], extent.low[1]},
                            .high = {extent.high[0], extent.high[1]},
                            .center = {},
                            .vertical_scale = import.vertical_scale};
  request.crs.option = import.crs;
  request.crs.wkt = info.crs_wkt;
  if (info.geo_keys) {
    request.crs.key_directory = info.geo_keys->directory;
    request.crs.key_numbers = info.geo_keys->numbers;
    request.crs.key_texts = info.geo_keys->texts;
  }
  if (import.center.size() >= 2) request.center = MapPoint{import.center[0], import.center[1]};
  return point_frame(request);
}

/// Converts points of a file to the site frame, and keeps those that count.
class SitePoints {
 public:
  SitePoints(const PointFrame& frame, double center_height, const std::string& name)
      : frame_(frame), center_height_(center_height), name_(name) {}

  void convert(CloudBatch& batch, ImportedPoints& points) const {
    keep_valid(batch);
    const std::size_t count = batch.size();
    points.columns.x_est.resize(count);
    points.columns.y_est.resize(count);
    points.columns.z_est.resize(count);
    points.columns.status.resize(count);
    parallel_for(count, frame_.one_thread ? std::max<std::size_t>(count, 1) : kPointsPerPiece,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t i = begin; i < end; ++i) place(batch, i, points.columns);
                 });
    for (std::size_t i = 0; i < count; ++i)
      if (!std::isfinite(points.columns.x_est[i]) || !std::isfinite(points.columns.y_est[i]))
        throw FormatError(name_ + ": the point at " + number_text(batch.columns[0][i]) + ", " +
                          number_text(batch.columns[1][i]) + " lies outside its map projection");
    integers(batch, CloudField::pulse, points.columns.pulse);
    integers(batch, CloudField::pixel, points.columns.pixel);
    integers(batch, CloudField::return_number, points.columns.return_number);
    const std::vector<double>& intensity = batch[CloudField::intensity];
    points.columns.intensity.assign(intensity.begin(), intensity.end());
    points.t = batch[CloudField::t];
  }

 private:
  /// Removes the other points.
  static void keep_valid(CloudBatch& batch) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (!is_finite_point(batch, i) || is_withheld(batch, i)) continue;
      if (next != i)
        for (auto& column : batch.columns)
          if (!column.empty()) column[next] = column[i];
      ++next;
    }
    for (auto& column : batch.columns)
      if (!column.empty()) column.resize(next);
  }

  void place(const CloudBatch& batch, std::size_t i, PointColumns& points) const {
    const MapPoint p{batch.columns[0][i], batch.columns[1][i]};
    const SitePoint at = frame_.site ? frame_.site(p)
                                     : SitePoint{(p.x - frame_.center.x) * frame_.metres_per_unit,
                                                 (p.y - frame_.center.y) * frame_.metres_per_unit};
    points.x_est[i] = at.x_m;
    points.y_est[i] = at.y_m;
    points.z_est[i] = (batch.columns[2][i] - center_height_) * frame_.metres_per_height;
    const std::vector<double>& classes = batch[CloudField::classification];
    const bool is_noise = !classes.empty() && (classes[i] == 7 || classes[i] == 18);
    points.status[i] = is_noise ? PointStatus::false_return : PointStatus::returned;
  }

  template <class T>
  void integers(const CloudBatch& batch, CloudField field, std::vector<T>& out) const {
    const std::vector<double>& values = batch[field];
    out.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!(values[i] >= 0 && values[i] <= static_cast<double>(std::numeric_limits<T>::max()) &&
            values[i] == std::floor(values[i])))
        throw FormatError(name_ + ": a " + name_of(field) + " of " + number_text(values[i]) +
                          " is not an integer in [0, " + std::to_string(std::numeric_limits<T>::max()) + "]");
      out[i] = static_cast<T>(values[i]);
    }
  }

  const PointFrame& frame_;
  double center_height_;
  const std::string& name_;
};

nlohmann::json config_of(const CloudImport& import, const CloudInfo& info, const PointFrame& frame,
                         const std::array<double, 3>& center) {
  nlohmann::json config = {
      {"source", std::filesystem::path(import.path).filename().string()},
      {"format", info.format},
      {"center", center},
      {"crs", frame.crs_name.empty() ? nlohmann::json() : nlohmann::json(frame.crs_name)},
      {"vertical_scale", frame.metres_per_height}};
  if (!import.columns.empty()) config["columns"] = import.columns;
  return config;
}

std::vector<std::string> warnings_of(const std::string& name, const CloudInfo& info, const PointFrame& frame,
                                     const Extent& extent) {
  std::vector<std::string> sentences = info.notes;
  sentences.insert(sentences.end(), frame.assumed.begin(), frame.assumed.end());
  if (extent.not_finite > 0)
    sentences.push_back(grouped(extent.not_finite) + " points without a finite position are left out");
  if (extent.withheld > 0)
    sentences.push_back(grouped(extent.withheld) + " points that it marks as withheld are left out");
  for (std::string& sentence : sentences) sentence.insert(0, name + ": ");
  return sentences;
}

void add_bounds(const PointColumns& points, std::array<std::array<double, 2>, 3>& bounds) {
  const std::array columns = {&points.x_est, &points.y_est, &points.z_est};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (columns[axis]->empty()) continue;
    const auto [low, high] = std::ranges::minmax(*columns[axis]);
    bounds[axis] = {std::min(bounds[axis][0], low), std::max(bounds[axis][1], high)};
  }
}

}  // namespace

ImportedCloud import_cloud(const CloudImport& import, ImportOutput output) {
  const std::unique_ptr<CloudReader> cloud = open_cloud(import.path, column_choice(import.columns));
  const CloudInfo& info = cloud->info();
  Extent extent;
  output.phase("measure",
               [&](const ProgressCallback& progress) { extent = extent_of(*cloud, import.path, progress); });
  const PointFrame frame = frame_of(import, info, extent);
  ImportedCloud result{
      .point_count = extent.count,
      .center = {frame.center.x, frame.center.y, import.center.size() > 2 ? import.center[2] : 0},
      .bounds_m = {},
      .format = info.format,
      .crs_name = frame.crs_name,
      .warnings = warnings_of(import.path, info, frame, extent)};
  result.bounds_m.fill({kInfinite, -kInfinite});
  output.provenance.config = config_of(import, info, frame, result.center);
  std::vector<std::string> assumed = info.notes;
  assumed.insert(assumed.end(), frame.assumed.begin(), frame.assumed.end());
  output.phase("identify", [&](const ProgressCallback&) {
    output.provenance.add_input("points", content_id(import.path), nlohmann::json::array(),
                                std::move(assumed));
  });
  LandfallFileWriter file(output.file, "scan", output.provenance);
  ImportedScanWriter writer(file,
                            {.intensity = info.has(CloudField::intensity),
                             .return_number = info.has(CloudField::return_number),
                             .t = info.has(CloudField::t),
                             .pulse = info.has(CloudField::pulse),
                             .pixel = info.has(CloudField::pixel),
                             .clock = info.clock},
                            raised(frame.crs_wkt, result.center[2] * frame.metres_per_height));
  output.phase("write", [&](const ProgressCallback& progress) {
    const SitePoints site(frame, result.center[2], import.path);
    ImportedPoints points;
    std::int64_t count = 0;
    for (CloudBatch batch; cloud->next(batch); report(progress, cloud->progress())) {
      site.convert(batch, points);
      count += static_cast<std::int64_t>(points.columns.size());
      add_bounds(points.columns, result.bounds_m);
      writer.append(points);
    }
    if (count != extent.count) throw FormatError(import.path + ": changed while it was read");
    writer.commit({result.center, info.format, std::isfinite(extent.first_t_s) ? extent.first_t_s : 0});
  });
  return result;
}

}  // namespace landfall
