// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/scan_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "base/error.h"
#include "base/parallel.h"
#include "files/crs.h"

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

using Coordinates = std::array<std::vector<double>*, 6>;

Coordinates coordinates(ScanPoints& p) {
  return {&p.x_est, &p.y_est, &p.z_est, &p.x_true, &p.y_true, &p.z_true};
}

std::array<std::span<const double>, 6> coordinates(const ScanPoints& p) {
  return {p.x_est, p.y_est, p.z_est, p.x_true, p.y_true, p.z_true};
}

bool is_finite(double value) { return std::abs(value) <= std::numeric_limits<double>::max(); }

void move_rows(std::vector<double>& column, std::size_t from, std::size_t count, std::size_t to) {
  const auto first = column.begin() + static_cast<std::ptrdiff_t>(from);
  std::copy(first, first + static_cast<std::ptrdiff_t>(count),
            column.begin() + static_cast<std::ptrdiff_t>(to));
}

/// Moves the first kept[i] rows of piece i up against those before it, and cuts what is left over.
void close_gaps(ScanPoints& points, std::size_t rows_per_piece, std::span<const std::size_t> kept) {
  std::vector<std::vector<double>*> columns = {&points.t};
  for (std::vector<double>* const column : coordinates(points)) columns.push_back(column);
  parallel_for(columns.size(), 1, [&](std::size_t c, std::size_t) {
    std::size_t end = 0;
    for (std::size_t piece = 0; piece < kept.size(); ++piece) {
      if (end != piece * rows_per_piece) move_rows(*columns[c], piece * rows_per_piece, kept[piece], end);
      end += kept[piece];
    }
    columns[c]->resize(end);
  });
}

}  // namespace

ScanWriter::ScanWriter(LandfallFileWriter& file, const ScanFileOptions& options, const std::string& crs_wkt)
    : file_(file),
      options_(options),
      points_(file.root(), "points", point_columns(options.single_precision), file.compression()),
      pulses_(file.root(), "pulses", pulse_columns(), file.compression()) {
  write_crs(file.root(), crs_wkt);
}

bool ScanWriter::copy_truth(const TableReader& source) {
  constexpr std::array kUnchanged = {"x_true", "y_true", "z_true", "range_true", "pulse", "pixel"};
  return points_.copy_columns(source, kUnchanged);
}

SinkWork ScanWriter::take(PulseBatch& batch) {
  const auto counts = batch.status_counts();
  for (std::size_t i = 0; i < counts.size(); ++i) counts_[i] += counts[i];
  if (!options_.keep_misses) batch.keep_returns();
  // Both tables are written in the order of the batches, for the file's layout follows from it.
  const Chunks pulses = take_pulses(batch.pulses);
  const Chunks points = take_points(batch.points);
  if (pulses.empty() && points.empty()) return {};
  return {[this, pulses, points] {
            for (const TableWriter::ChunkPtr& chunk : pulses) pulses_.encode(*chunk);
            for (const TableWriter::ChunkPtr& chunk : points) points_.encode(*chunk);
          },
          [this, pulses, points] {
            for (const TableWriter::ChunkPtr& chunk : pulses) pulses_.write(chunk);
            for (const TableWriter::ChunkPtr& chunk : points) points_.write(chunk);
          }};
}

ScanWriter::Chunks ScanWriter::take_points(const PointColumns& points) {
  std::vector<ColumnRows> rows;
  PointColumns::for_each(points, [&](const char*, const auto& column) {
    using Value = typename std::decay_t<decltype(column)>::value_type;
    if constexpr (std::is_same_v<Value, PointStatus>) {
      rows.emplace_back(as_int8(column));
    } else {
      rows.emplace_back(std::span<const Value>(column));
    }
  });
  return points_.take(rows);
}

ScanWriter::Chunks ScanWriter::take_pulses(const PulseColumns& pulses) {
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
  return pulses_.take(rows);
}

std::array<std::pair<const char*, std::int64_t>, 5> ScanWriter::counts() const {
  using enum PointStatus;
  return {{{"return_count", count(returned)},
           {"miss_count", count(miss)},
           {"dropout_count", count(dropout)},
           {"dead_count", count(dead)},
           {"false_return_count", count(false_return)}}};
}

void ScanWriter::refuse_without_return() const {
  std::string causes;
  const auto name = [&](PointStatus status, const char* what) {
    if (count(status) > 0) causes += (causes.empty() ? "" : ", ") + std::to_string(count(status)) + what;
  };
  name(PointStatus::miss, " misses");
  name(PointStatus::dropout, " dropouts");
  name(PointStatus::dead, " of dead pixels");
  name(PointStatus::blanked, " of blanked pulses");
  name(PointStatus::lost_in_optics, " lost in the scanner (total reflection)");
  throw FormatError("the scan has no return: " + causes +
                    (count(PointStatus::miss) > 0 ? "; does it look at the terrain?" : ""));
}

void ScanWriter::commit(const Detector& detector, std::span<const std::int8_t> dead_map) {
  if (count(PointStatus::returned) + count(PointStatus::false_return) == 0) refuse_without_return();
  points_.finish();
  pulses_.finish();
  h5::write_attribute(points_.group(), "misses_kept", std::int64_t{options_.keep_misses ? 1 : 0});
  for (const auto& [name, number] : counts()) h5::write_attribute(points_.group(), name, number);
  write_detector(file_, detector, dead_map);
  file_.commit();
}

ScanReader::ScanReader(const std::filesystem::path& path)
    : file_(path, {"scan"}),
      points_(file_.root(), "points", file_.name()),
      columns_(points_, {"x_est", "y_est", "z_est", "x_true", "y_true", "z_true", "pulse", "status"}),
      pulse_times_s_(read_pulse_times(file_)),
      crs_wkt_(read_crs(file_.root())),
      row_count_(points_.row_count("pulse")) {
  for (const char* const column : kCoordinates)
    if (points_.row_count(column) != row_count_)
      file_.fail("columns /points/pulse and /points/" + std::string(column) + " differ in length");
  if (points_.row_count("status") != row_count_)
    file_.fail("columns /points/pulse and /points/status differ in length");
}

bool ScanReader::is_valid(const ScanPoints& points, std::size_t i) const {
  if (!is_return(PointStatus{status_[i]})) return true;
  return pulse_[i] >= 0 && static_cast<std::size_t>(pulse_[i]) < pulse_times_s_.size() &&
         std::ranges::all_of(coordinates(points), [i](auto column) { return is_finite(column[i]); });
}

bool ScanReader::all_valid(const ScanPoints& points, std::size_t first, std::size_t end) const {
  bool valid = true;  // no early exit: the loops then run as fast as memory
  for (std::size_t i = first; i < end; ++i) valid &= is_return(PointStatus{status_[i]});
  for (std::size_t i = first; i < end; ++i)
    valid &= pulse_[i] >= 0 && static_cast<std::size_t>(pulse_[i]) < pulse_times_s_.size();
  for (const std::span<const double> column : coordinates(points))
    for (std::size_t i = first; i < end; ++i) valid &= is_finite(column[i]);
  if (valid) return true;
  for (std::size_t i = first; i < end; ++i)
    if (!is_valid(points, i)) return false;
  return true;
}

void ScanReader::fail_at_row(const ScanPoints& points, std::size_t i, std::size_t row) const {
  if (pulse_[i] < 0 || static_cast<std::size_t>(pulse_[i]) >= pulse_times_s_.size())
    file_.fail("/points/pulse[" + std::to_string(row) + "] = " + std::to_string(pulse_[i]) +
               " is no row of /pulses (" + std::to_string(pulse_times_s_.size()) + ")");
  std::size_t c = 0;
  while (is_finite(coordinates(points)[c][i])) ++c;
  file_.fail("/points/" + std::string(kCoordinates[c]) + "[" + std::to_string(row) +
             "] of a return is not finite");
}

/// Packs the returns among [first, end) at `first`; returns their number.
std::size_t ScanReader::keep_returns(ScanPoints& points, std::size_t first, std::size_t end) const {
  std::size_t next = first;
  for (std::size_t i = first; i < end; ++i) {
    if (!is_return(PointStatus{status_[i]})) continue;
    points.t[next] = pulse_times_s_[static_cast<std::size_t>(pulse_[i])];
    if (next != i)
      for (std::vector<double>* const column : coordinates(points)) (*column)[next] = (*column)[i];
    ++next;
  }
  return next - first;
}

void ScanReader::read(std::size_t begin, std::size_t count, ScanPoints& points) {
  constexpr std::size_t kRowsPerPiece = 1U << 14U;
  std::vector<ColumnTarget> targets;
  for (std::vector<double>* const column : coordinates(points)) {
    column->resize(count);
    targets.emplace_back(std::span(*column));
  }
  points.t.resize(count);
  pulse_.resize(count);
  status_.resize(count);
  targets.emplace_back(std::span(pulse_));
  targets.emplace_back(std::span(status_));
  columns_.read(begin, targets);
  std::vector<std::size_t> kept((count + kRowsPerPiece - 1) / kRowsPerPiece);
  std::vector<char> valid(kept.size());
  parallel_for(count, kRowsPerPiece, [&](std::size_t first, std::size_t end) {
    const std::size_t piece = first / kRowsPerPiece;
    valid[piece] = all_valid(points, first, end) ? 1 : 0;
    if (valid[piece] != 0) kept[piece] = keep_returns(points, first, end);
  });
  const auto bad_piece = static_cast<std::size_t>(std::ranges::find(valid, 0) - valid.begin());
  for (std::size_t i = bad_piece * kRowsPerPiece; i < count; ++i)
    if (!is_valid(points, i)) fail_at_row(points, i, begin + i);
  close_gaps(points, kRowsPerPiece, kept);
}

}  // namespace landfall
