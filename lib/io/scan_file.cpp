// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scan_file.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/error.h"
#include "io/crs.h"

namespace landfall {
namespace {

std::vector<ColumnSpec> point_columns(bool single_precision) {
  const h5::Type real = single_precision ? h5::Type::float32 : h5::Type::float64;
  return {{"x_est", real, "m", "estimated x in the DEM frame"},
          {"y_est", real, "m", "estimated y in the DEM frame"},
          {"z_est", real, "m", "estimated z in the DEM frame"},
          {"x_true", real, "m", "true x in the DEM frame"},
          {"y_true", real, "m", "true y in the DEM frame"},
          {"z_true", real, "m", "true z in the DEM frame"},
          {"range_true", real, "m", "true range"},
          {"range_measured", real, "m", "measured range"},
          {"pulse", h5::Type::int32, "1", "row in /pulses"},
          {"pixel", h5::Type::int32, "1", "row * columns + column on the detector"},
          {"status",
           h5::Type::int8,
           "1",
           "what became of the pixel at this pulse",
           {0, 1, 2, 3, 4, 5, 6},
           "return miss dropout dead blanked total_reflection false_return"}};
}

std::vector<ColumnSpec> pulse_columns() {
  const auto real = [](const char* name, const char* units, const char* long_name) {
    return ColumnSpec{name, h5::Type::float64, units, long_name};
  };
  return {real("t", "s", "time of the pulse"),
          real("angle_1", "rad", "scanner angle 1"),
          real("angle_2", "rad", "scanner angle 2"),
          real("px_true", "m", "true body position x"),
          real("py_true", "m", "true body position y"),
          real("pz_true", "m", "true body position z"),
          real("qw_true", "1", "true attitude, quaternion DEM <- body, scalar"),
          real("qx_true", "1", "true attitude, quaternion DEM <- body, x"),
          real("qy_true", "1", "true attitude, quaternion DEM <- body, y"),
          real("qz_true", "1", "true attitude, quaternion DEM <- body, z"),
          real("px_est", "m", "estimated body position x"),
          real("py_est", "m", "estimated body position y"),
          real("pz_est", "m", "estimated body position z"),
          real("qw_est", "1", "estimated attitude, quaternion DEM <- body, scalar"),
          real("qx_est", "1", "estimated attitude, quaternion DEM <- body, x"),
          real("qy_est", "1", "estimated attitude, quaternion DEM <- body, y"),
          real("qz_est", "1", "estimated attitude, quaternion DEM <- body, z"),
          {"point_count", h5::Type::int32, "1", "rows of the pulse in /points"},
          {"point_begin", h5::Type::int64, "1", "first row of the pulse in /points"}};
}

std::span<const std::int8_t> as_int8(const std::vector<PointStatus>& statuses) {
  static_assert(sizeof(PointStatus) == 1);
  return {reinterpret_cast<const std::int8_t*>(statuses.data()), statuses.size()};
}

void write_detector(LandfallFileWriter& file, const Detector& detector,
                    std::span<const std::int8_t> dead_map) {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> z;
  for (const Direction<LidarFrame>& pixel : detector.pixels()) {
    x.push_back(pixel.v.x());
    y.push_back(pixel.v.y());
    z.push_back(pixel.v.z());
  }
  const std::array<ColumnRows, 4> rows = {std::span<const double>(x), std::span<const double>(y),
                                          std::span<const double>(z), dead_map};
  write_table(file.root(), "detector",
              {{"direction_x", h5::Type::float64, "1", "pixel direction in the lidar frame, x"},
               {"direction_y", h5::Type::float64, "1", "pixel direction in the lidar frame, y"},
               {"direction_z", h5::Type::float64, "1", "pixel direction in the lidar frame, z"},
               {"dead", h5::Type::int8, "1", "pixel never returns", {0, 1}, "alive dead"}},
              rows, file.compression());
}

std::vector<double> read_pulse_times(const LandfallFileReader& file) {
  const TableReader pulses(file.root(), "pulses", file.name());
  std::vector<double> times(pulses.row_count("t"));
  pulses.read("t", 0, std::span(times));
  return times;
}

constexpr std::array<const char*, 6> kCoordinates = {"x_est", "y_est", "z_est", "x_true", "y_true", "z_true"};

}  // namespace

ScanWriter::ScanWriter(LandfallFileWriter& file, const ScanFileOptions& options, const std::string& crs_wkt)
    : file_(file),
      options_(options),
      points_(file.root(), "points", point_columns(options.single_precision), file.compression()),
      pulses_(file.root(), "pulses", pulse_columns(), file.compression()) {
  write_crs(file.root(), crs_wkt);
}

void ScanWriter::copy_truth(const TableReader& source) {
  constexpr std::array kUnchanged = {"x_true", "y_true", "z_true", "range_true", "pulse", "pixel"};
  points_.copy_columns(source, kUnchanged);
}

void ScanWriter::append(PulseBatch& batch) {
  const auto counts = batch.status_counts();
  for (std::size_t i = 0; i < counts.size(); ++i) counts_[i] += counts[i];
  if (!options_.keep_misses) batch.keep_returns();
  append_pulses(batch.pulses);
  append_points(batch.points);
}

void ScanWriter::append_points(const PointColumns& points) {
  std::vector<ColumnRows> rows;
  PointColumns::for_each(points, [&](const char*, const auto& column) {
    using Value = typename std::decay_t<decltype(column)>::value_type;
    if constexpr (std::is_same_v<Value, PointStatus>) {
      rows.emplace_back(as_int8(column));
    } else {
      rows.emplace_back(std::span<const Value>(column));
    }
  });
  points_.append(rows);
}

void ScanWriter::append_pulses(const PulseColumns& pulses) {
  std::vector<std::int64_t> begin;
  auto next = static_cast<std::int64_t>(points_.row_count());
  for (const std::int32_t count : pulses.point_count) {
    begin.push_back(next);
    next += count;
  }
  std::vector<ColumnRows> rows;
  PulseColumns::for_each(pulses, [&](const char*, const auto& column) {
    rows.emplace_back(std::span<const typename std::decay_t<decltype(column)>::value_type>(column));
  });
  rows.emplace_back(std::span<const std::int64_t>(begin));
  pulses_.append(rows);
}

void ScanWriter::commit(const Detector& detector, std::span<const std::int8_t> dead_map) {
  if (count(PointStatus::returned) + count(PointStatus::false_return) == 0)
    throw FormatError("the scan has no return: " + std::to_string(count(PointStatus::miss)) + " misses, " +
                      std::to_string(count(PointStatus::dropout)) + " dropouts, " +
                      std::to_string(count(PointStatus::dead)) +
                      " of dead pixels; does it look at the terrain?");
  points_.finish();
  pulses_.finish();
  h5::write_attribute(points_.group(), "misses_kept", std::int64_t{options_.keep_misses ? 1 : 0});
  h5::write_attribute(points_.group(), "return_count", count(PointStatus::returned));
  h5::write_attribute(points_.group(), "miss_count", count(PointStatus::miss));
  h5::write_attribute(points_.group(), "dropout_count", count(PointStatus::dropout));
  h5::write_attribute(points_.group(), "dead_count", count(PointStatus::dead));
  write_detector(file_, detector, dead_map);
  file_.commit();
}

ScanReader::ScanReader(const std::filesystem::path& path)
    : file_(path, {"scan"}),
      points_(file_.root(), "points", file_.name()),
      pulse_times_s_(read_pulse_times(file_)),
      crs_wkt_(read_crs(file_.root())),
      row_count_(points_.row_count("pulse")) {
  for (const char* const column : kCoordinates)
    if (points_.row_count(column) != row_count_)
      file_.fail("columns /points/pulse and /points/" + std::string(column) + " differ in length");
  if (points_.row_count("status") != row_count_)
    file_.fail("columns /points/pulse and /points/status differ in length");
}

bool ScanReader::is_return(std::int8_t status) const {
  const auto what = static_cast<PointStatus>(status);
  return what == PointStatus::returned || what == PointStatus::false_return;
}

double ScanReader::pulse_time_s(std::int32_t pulse, std::size_t row) const {
  if (pulse < 0 || static_cast<std::size_t>(pulse) >= pulse_times_s_.size())
    file_.fail("/points/pulse[" + std::to_string(row) + "] = " + std::to_string(pulse) +
               " is no row of /pulses (" + std::to_string(pulse_times_s_.size()) + ")");
  return pulse_times_s_[static_cast<std::size_t>(pulse)];
}

void ScanReader::read(std::size_t begin, std::size_t count, ScanPoints& points) const {
  const std::array<std::vector<double>*, 6> columns = {&points.x_est,  &points.y_est,  &points.z_est,
                                                       &points.x_true, &points.y_true, &points.z_true};
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c]->resize(count);
    points_.read(kCoordinates[c], begin, std::span(*columns[c]));
  }
  std::vector<std::int32_t> pulse(count);
  std::vector<std::int8_t> status(count);
  points_.read("pulse", begin, std::span(pulse));
  points_.read("status", begin, std::span(status));
  points.t.resize(count);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_return(status[i])) continue;
    points.t[kept] = pulse_time_s(pulse[i], begin + i);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double value = (*columns[c])[i];
      if (!std::isfinite(value))
        file_.fail("/points/" + std::string(kCoordinates[c]) + "[" + std::to_string(begin + i) +
                   "] of a return is not finite");
      (*columns[c])[kept] = value;
    }
    ++kept;
  }
  for (std::vector<double>* const column : columns) column->resize(kept);
  points.t.resize(kept);
}

}  // namespace landfall
