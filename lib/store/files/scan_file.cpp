// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/scan_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/core/error.h"
#include "base/core/mapped.h"
#include "base/core/parallel.h"
#include "base/text/joined.h"
#include "store/files/column_specs.h"
#include "store/files/crs.h"
#include "store/files/imported_scan.h"

namespace landfall {
namespace {

template <class Columns>
std::vector<ColumnSpec> specs_of(const Columns& columns, const ScanFileOptions& options) {
  std::vector<ColumnSpec> specs;
  for_each_column(columns, [&](const auto& column) {
    if (options.columns.has(column.group)) specs.push_back(spec_of(column, options.single_precision));
  });
  return specs;
}

/// The rows of every column, in the order of specs_of().
template <class Columns, class Table>
std::vector<ColumnRows> rows_of(const Columns& columns, const Table& table, const OptionalColumns& present) {
  std::vector<ColumnRows> all;
  for_each_column(columns, [&](const auto& column) {
    if (!present.has(column.group)) return;
    all.push_back(rows_of_column(column, table));
  });
  return all;
}

void write_detector(LandfallFileWriter& file, const Detector& detector,
                    std::span<const std::int8_t> dead_map) {
  const auto axis = [&](Eigen::Index i) {
    return mapped(detector.pixels(), [i](const Direction<LidarFrame>& pixel) { return pixel.v[i]; });
  };
  const std::vector<double> x = axis(0), y = axis(1), z = axis(2);
  const std::array<ColumnRows, 4> rows = {std::span(x), std::span(y), std::span(z), dead_map};
  write_table(file.root(), "detector",
              {{"direction_x", h5::Type::float64, "1", "pixel direction in the lidar frame, x"},
               {"direction_y", h5::Type::float64, "1", "pixel direction in the lidar frame, y"},
               {"direction_z", h5::Type::float64, "1", "pixel direction in the lidar frame, z"},
               {"dead", h5::Type::int8, "1", "pixel never returns", {0, 1}, "alive dead"}},
              rows, file.compression());
}

constexpr const char* kPulseTime = name_of(&PulseColumns::t);

bool is_finite(double value) { return std::abs(value) <= std::numeric_limits<double>::max(); }

void move_rows(std::vector<double>& column, std::size_t from, std::size_t count, std::size_t to) {
  const auto first = column.begin() + static_cast<std::ptrdiff_t>(from);
  std::copy(first, first + static_cast<std::ptrdiff_t>(count),
            column.begin() + static_cast<std::ptrdiff_t>(to));
}

/// The columns from which a DEM is made, in the order in which ScanReader::read() takes them.
std::vector<std::string> columns_of_a_dem(bool is_imported, bool has_times) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < (is_imported ? 3 : kCoordinates.size()); ++i)
    names.emplace_back(name_of(kCoordinates[i]));
  if (!is_imported) names.emplace_back(name_of(&PointColumns::pulse));
  names.emplace_back(name_of(&PointColumns::status));
  if (is_imported && has_times) names.emplace_back(kPulseTime);
  return names;
}

/// Imported points have no truth: their estimates stand for it, so that no bin has an offset.
void use_estimates_as_truth(PointColumns& points) {
  points.x_true = points.x_est;
  points.y_true = points.y_est;
  points.z_true = points.z_est;
}

/// Moves the first kept[i] rows of each piece i to directly after those before it, and removes the rest.
void close_gaps(ScanPoints& points, std::size_t rows_per_piece, std::span<const std::size_t> kept) {
  std::vector<std::vector<double>*> columns = {&points.t};
  for (const auto member : kCoordinates) columns.push_back(&(points.columns.*member));
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
      points_(file.root(), "points", specs_of(kPointColumns, options), file.compression()),
      pulses_(file.root(), "pulses", specs_of(kPulseColumns, {}), file.compression()) {
  if (options.columns.later_echoes)
    later_echoes_.emplace(file.root(), kEchoGroup, specs_of(kEchoColumns, {}), file.compression());
  write_crs(file.root(), crs_wkt);
}

bool ScanWriter::copy_truth(const TableReader& source) {
  std::vector<const char*> unchanged;
  for_each_column(kPointColumns, [&](const auto& column) {
    if (column.effect == ErrorEffect::unchanged && options_.columns.has(column.group))
      unchanged.push_back(column.name);
  });
  return points_.copy_columns(source, unchanged);
}

SinkWork ScanWriter::take(PulseBatch& batch) {
  const auto counts = batch.status_counts();
  for (std::size_t i = 0; i < counts.size(); ++i) counts_[i] += counts[i];
  if (!options_.keep_misses) batch.keep_returns();
  // The tables are written in the order of the batches, because the file's layout depends on it.
  auto next = static_cast<std::int64_t>(points_.row_count());
  for (std::size_t i = 0; i < batch.pulses.size(); ++i) {
    batch.pulses.point_begin[i] = next;
    next += batch.pulses.point_count[i];
  }
  std::vector<Taken> all = {{&pulses_, pulses_.take(rows_of(kPulseColumns, batch.pulses, {}))},
                            {&points_, points_.take(rows_of(kPointColumns, batch.points, options_.columns))}};
  if (later_echoes_)
    all.push_back({&*later_echoes_, later_echoes_->take(rows_of(kEchoColumns, batch.later_echoes, {}))});
  std::erase_if(all, [](const Taken& taken) { return taken.chunks.empty(); });
  if (all.empty()) return {};
  return {[all] {
            for (const Taken& taken : all)
              for (const TableWriter::ChunkPtr& chunk : taken.chunks) taken.table->encode(*chunk);
          },
          [all] {
            for (const Taken& taken : all)
              for (const TableWriter::ChunkPtr& chunk : taken.chunks) taken.table->write(chunk);
          }};
}

void ScanWriter::refuse_without_return() const {
  const std::string causes = joined(kPointStatuses, ", ", [this](const PointStatusInfo& info) {
    return count(info.status) > 0 ? std::to_string(count(info.status)) + info.cause : "";
  });
  throw FormatError("the scan has no return: " + causes +
                    (count(PointStatus::miss) > 0 ? "; does the lidar point at the terrain?" : ""));
}

void ScanWriter::commit(const Detector& detector, std::span<const std::int8_t> dead_map) {
  if (count(PointStatus::returned) + count(PointStatus::false_return) == 0) refuse_without_return();
  points_.finish();
  pulses_.finish();
  if (later_echoes_) later_echoes_->finish();
  h5::write_attribute(points_.group(), "misses_kept", std::int64_t{options_.keep_misses ? 1 : 0});
  for (const PointStatusInfo& info : kPointStatuses)
    if (info.is_counted(options_.columns.intensity))
      h5::write_attribute(points_.group(), info.count_name, count(info.status));
  write_detector(file_, detector, dead_map);
  name_rows(file_.root(), "points", "point");
  name_rows(file_.root(), "pulses", "pulse");
  name_rows(file_.root(), "detector", "pixel");
  if (later_echoes_ && later_echoes_->row_count() > 0) name_rows(file_.root(), kEchoGroup, "echo");
  file_.commit();
}

std::vector<double> read_pulse_times(const LandfallFileReader& scan) {
  const TableReader pulses(scan.root(), "pulses", scan.name());
  const std::string name = name_of(&PulseColumns::t);
  std::vector<double> times(pulses.row_count(name));
  pulses.read(name, 0, std::span(times));
  const auto bad = std::ranges::find_if_not(times, is_finite);
  if (bad != times.end())
    scan.fail(pulses.path_of(name) + "[" + std::to_string(bad - times.begin()) + "] is not finite");
  return times;
}

PulseTimes times_since_first(std::vector<double> times_s, std::optional<double> rate_hz) {
  PulseTimes times{times_s.empty() ? 0 : times_s.front(), std::move(times_s)};
  const auto since_start = [&](std::size_t k) { return static_cast<double>(k) / *rate_hz; };
  bool is_regular = rate_hz.has_value();
  for (std::size_t k = 0; k < times.since_s.size() && is_regular; ++k) {
    const double rounding = 0x1p-52 * std::max(std::abs(times.epoch_s), std::abs(times.since_s[k]));
    is_regular = std::abs(times.since_s[k] - times.epoch_s - since_start(k)) <= rounding;
  }
  for (std::size_t k = 0; k < times.since_s.size(); ++k)
    times.since_s[k] = is_regular ? since_start(k) : times.since_s[k] - times.epoch_s;
  return times;
}

PulseTimes read_pulse_times_since_first(const LandfallFileReader& scan) {
  const nlohmann::json::json_pointer where("/laser/pulse_rate_hz");
  const nlohmann::json& config = scan.config();
  std::optional<double> rate_hz;
  if (config.is_object() && config.contains(where) && config.at(where).is_number() && config.at(where) > 0)
    rate_hz = config.at(where).get<double>();
  return times_since_first(read_pulse_times(scan), rate_hz);
}

void ScanReader::count_from(double epoch_s) {
  const double lead_s = pulse_times_.epoch_s - epoch_s;
  for (double& time_s : pulse_times_.since_s) time_s += lead_s;
  pulse_times_.epoch_s = epoch_s;
}

ScanReader::ScanReader(const std::filesystem::path& path)
    : file_(path, {"scan"}),
      points_(file_.root(), "points", file_.name()),
      is_imported_(is_imported_scan(file_)),
      has_times_(!is_imported_ || points_.has(kPulseTime)),
      columns_(points_, columns_of_a_dem(is_imported_, has_times_)),
      pulse_times_(is_imported_ ? PulseTimes{.epoch_s = imported_epoch_s(file_)}
                                : read_pulse_times_since_first(file_)),
      crs_wkt_(read_crs(file_)),
      row_count_(points_.row_count(row_column())) {
  for (const std::string& column : columns_of_a_dem(is_imported_, has_times_))
    if (points_.row_count(column) != row_count_)
      file_.fail(std::string("columns /points/") + row_column() + " and /points/" + column +
                 " differ in length");
}

const char* ScanReader::row_column() const {
  return is_imported_ ? name_of(&PointColumns::status) : name_of(&PointColumns::pulse);
}

bool ScanReader::is_valid(const ScanPoints& points, std::size_t i) const {
  return !is_return(PointStatus{status_[i]}) ||
         (has_pulse(i) && has_valid_time(points, i) && std::ranges::all_of(kCoordinates, [&](auto member) {
            return is_finite((points.columns.*member)[i]);
          }));
}

bool ScanReader::all_valid(const ScanPoints& points, std::size_t first, std::size_t end) const {
  bool valid = true;  // no early exit, so that the loops run at memory speed
  for (std::size_t i = first; i < end; ++i) valid &= is_return(PointStatus{status_[i]});
  for (std::size_t i = first; i < end; ++i) valid &= has_pulse(i);
  for (std::size_t i = first; is_imported_ && i < end; ++i) valid &= is_finite(points.t[i]);
  for (const auto member : kCoordinates) {
    const std::span<const double> column = points.columns.*member;
    for (std::size_t i = first; i < end; ++i) valid &= is_finite(column[i]);
  }
  if (valid) return true;
  for (std::size_t i = first; i < end; ++i)
    if (!is_valid(points, i)) return false;
  return true;
}

void ScanReader::fail_at_row(const ScanPoints& points, std::size_t i, std::size_t row) const {
  if (!has_pulse(i))
    file_.fail("/points/pulse[" + std::to_string(row) + "] = " + std::to_string(pulse_[i]) +
               " is not a row of /pulses (" + std::to_string(pulse_times_.since_s.size()) + ")");
  if (!has_valid_time(points, i))
    file_.fail("/points/" + std::string(kPulseTime) + "[" + std::to_string(row) +
               "] of a return is not finite");
  const auto* const bad = std::ranges::find_if_not(
      kCoordinates, [&](auto member) { return is_finite((points.columns.*member)[i]); });
  file_.fail("/points/" + std::string(name_of(*bad)) + "[" + std::to_string(row) +
             "] of a return is not finite");
}

/// Packs the returns among [first, end) at `first`; returns their number.
std::size_t ScanReader::keep_returns(ScanPoints& points, std::size_t first, std::size_t end) const {
  std::size_t next = first;
  for (std::size_t i = first; i < end; ++i) {
    if (!is_return(PointStatus{status_[i]})) continue;
    points.t[next] = is_imported_ ? points.t[i] - pulse_times_.epoch_s
                                  : pulse_times_.since_s[static_cast<std::size_t>(pulse_[i])];
    if (next != i)
      for (const auto member : kCoordinates) (points.columns.*member)[next] = (points.columns.*member)[i];
    ++next;
  }
  return next - first;
}

/// In the order of columns_of_a_dem().
void ScanReader::read_columns(std::size_t begin, std::size_t count, ScanPoints& points) {
  std::vector<ColumnTarget> targets;
  for (std::size_t i = 0; i < (is_imported_ ? 3 : kCoordinates.size()); ++i) {
    std::vector<double>& column = points.columns.*kCoordinates[i];
    column.resize(count);
    targets.emplace_back(std::span(column));
  }
  points.t.resize(count);
  if (is_imported_) std::ranges::fill(points.t, pulse_times_.epoch_s);
  pulse_.resize(is_imported_ ? 0 : count);
  status_.resize(count);
  if (!is_imported_) targets.emplace_back(std::span(pulse_));
  targets.emplace_back(std::span(status_));
  if (is_imported_ && has_times_) targets.emplace_back(std::span(points.t));
  columns_.read(begin, targets);
  if (is_imported_) use_estimates_as_truth(points.columns);
}

void ScanReader::read(std::size_t begin, std::size_t count, ScanPoints& points) {
  constexpr std::size_t kRowsPerPiece = 1U << 14U;
  read_columns(begin, count, points);
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
