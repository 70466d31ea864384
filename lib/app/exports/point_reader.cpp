// SPDX-License-Identifier: GPL-3.0-or-later
// Points without a return are omitted from every export except a .csv that requests them.
#include "app/exports/point_reader.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/exports/grid_layers.h"
#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/returns/columns.h"
#include "base/text/joined.h"
#include "store/files/imported_scan.h"
#include "store/hdf5/column_reader.h"

namespace landfall {
namespace {

/// Rows that one thread encodes at a time.
constexpr std::size_t kPieceRows = 8192;

constexpr const char* kTime = name_of(&PulseColumns::t);
constexpr const char* kPulse = name_of(&PointColumns::pulse);
constexpr const char* kStatus = name_of(&PointColumns::status);

bool is_real(const ContentInfo& column) {
  return column.type == h5::Type::float64 || column.type == h5::Type::float32;
}

ColumnValues values_of(h5::Type type) {
  switch (type) {
    case h5::Type::int8:
      return std::vector<std::int8_t>();
    case h5::Type::int32:
      return std::vector<std::int32_t>();
    case h5::Type::int64:
      return std::vector<std::int64_t>();
    default:
      return std::vector<double>();
  }
}

ColumnTarget resized(ColumnValues& values, std::size_t count) {
  return std::visit(
      [count](auto& column) -> ColumnTarget {
        column.resize(count);
        return std::span(column);
      },
      values);
}

/// The column whose length the others must have.
std::string first_of(const TableReader& points) {
  return points.has(kStatus) ? kStatus : name_of(&PointColumns::x_est);
}

std::vector<double> stored_times(const LandfallFileReader& file) {
  const bool has_times =
      h5::exists(file.root(), "pulses") && TableReader(file.root(), "pulses", file.name()).has(kTime);
  return has_times ? read_pulse_times(file) : std::vector<double>();
}

}  // namespace

double PointBatch::number(std::size_t column, std::size_t row) const {
  return std::visit([row](const auto& values) { return static_cast<double>(values[row]); }, columns[column]);
}

PointReader::PointReader(const std::filesystem::path& path)
    : file_(path, {"scan"}),
      points_(file_.root(), "points", file_.name()),
      columns_(columns_of(points_)),
      is_imported_(is_imported_scan(file_)),
      stored_times_s_(stored_times(file_)),
      pulse_times_(stored_times_s_.empty() ? PulseTimes{.epoch_s = imported_epoch_s(file_)}
                                           : read_pulse_times_since_first(file_)),
      row_count_(points_.row_count(first_of(points_))) {
  require_positions();
  const std::string first = first_of(points_);
  for (const ContentInfo& column : columns_)
    if (points_.row_count(column.name) != row_count_)
      file_.fail("/points/" + column.name + " has another length than /points/" + first);
  if (!stored_times_s_.empty() && points_.has(kPulse) && !points_.has(kTime)) {
    const auto& time = std::get<0>(kPulseColumns);
    columns_.push_back({time.name, h5::Type::float64, time.units, time.long_name});
  }
}

void PointReader::require_positions() const {
  for (const auto member : kCoordinates) {
    const std::string name = name_of(member);
    const auto found = std::ranges::find(columns_, name, &ContentInfo::name);
    const bool is_optional = name.ends_with("_true");
    if (found == columns_.end() ? !is_optional : !is_real(*found))
      file_.fail("no floating-point column /points/" + name);
  }
}

bool PointReader::has(const std::string& name) const {
  return std::ranges::find(columns_, name, &ContentInfo::name) != columns_.end();
}

const ContentInfo& PointReader::column(const std::string& name) const {
  const auto found = std::ranges::find(columns_, name, &ContentInfo::name);
  if (found == columns_.end())
    throw UsageError(file_.name() + ": no column '" + name + "'; it has " +
                     joined(columns_, ", ", &ContentInfo::name));
  return *found;
}

void PointReader::place_on(MapFrame map) { map_ = std::move(map); }

ContentInfo PointReader::read_column(const std::string& name) const {
  const ContentInfo& stored = column(name);
  const auto* const found =
      std::ranges::find(kCoordinates, name, [](auto member) { return name_of(member); });
  if (!map_ || found == kCoordinates.end()) return stored;
  constexpr std::array kPlanar = {"easting", "northing", "elevation"};
  constexpr std::array kGeographic = {"longitude", "latitude", "elevation"};
  const auto i = static_cast<std::size_t>(found - kCoordinates.begin());
  const std::string axis = (map_->is_geographic ? kGeographic : kPlanar)[i % 3];
  return {axis + (i < 3 ? "" : "_true"), h5::Type::float64,
          i % 3 < 2 ? map_->unit : length_unit_name(map_->metres_per_height),
          axis + (i < 3 ? ", estimated" : ", true") + " position in " + map_->crs_name};
}

std::vector<std::string> PointReader::choose(const std::vector<std::string>& names) const {
  for (auto name = names.begin(); name != names.end(); ++name)
    if (std::find(names.begin(), name, *name) != name)
      throw UsageError("--columns names " + *name + " twice");
  for (const std::string& name : names) static_cast<void>(column(name));
  if (!names.empty()) return names;
  std::vector<std::string> all;
  for (const ContentInfo& column : columns_)
    if (column.name != "t") all.push_back(column.name);
  return all;
}

std::size_t PointReader::count(const PointSelection& selection) const {
  std::size_t selected = row_count_;
  if (selection.only_returns && has(kStatus)) {
    selected = 0;
    std::vector<std::int8_t> status(std::min(row_count_, kBatchRows));
    ColumnReader reader(points_, {kStatus});
    for (std::size_t begin = 0; begin < row_count_; begin += kBatchRows) {
      const std::span rows(status.data(), std::min(kBatchRows, row_count_ - begin));
      const ColumnTarget target = rows;
      reader.read(begin, std::span(&target, 1));
      selected += static_cast<std::size_t>(std::count_if(
          rows.begin(), rows.end(), [](std::int8_t value) { return is_return(PointStatus{value}); }));
    }
  }
  return (selected + selection.every - 1) / selection.every;
}

/// Reads the batches of a pass in order.
class PointReader::BatchSource {
 public:
  BatchSource(const PointReader& reader, const Pass& pass)
      : reader_(reader),
        pass_(pass),
        reads_status_(pass.selection.only_returns && reader.has(kStatus)),
        columns_(reader.points_, stored_columns(pass)) {}

  void read(std::size_t begin, std::size_t count, PointBatch& batch) {
    batch.first_row = begin;
    batch.columns.resize(pass_.columns.size());
    std::vector<ColumnTarget> targets;
    for (std::size_t c = 0; c < pass_.columns.size(); ++c)
      if (pass_.columns[c] != kTime || !wants_time_) targets.push_back(target(c, count, batch));
    if (wants_time_) {
      pulse_.resize(count);
      targets.emplace_back(std::span(pulse_));
    }
    if (reads_status_) {
      status_.resize(count);
      targets.emplace_back(std::span(status_));
    }
    columns_.read(begin, targets);
    select(count, batch);
    if (wants_time_) look_up_times(batch);
    if (pass_.first_time_s && reader_.is_imported_) shift_times(batch);
    if (reader_.map_) place(batch);
    require_finite(batch);
  }

 private:
  ColumnTarget target(std::size_t c, std::size_t count, PointBatch& batch) const {
    ColumnValues wanted = values_of(reader_.column(pass_.columns[c]).type);
    if (batch.columns[c].index() != wanted.index()) batch.columns[c] = std::move(wanted);
    return resized(batch.columns[c], count);
  }

  /// The columns to read from the file: `t` is computed from the pulse.
  std::vector<std::string> stored_columns(const Pass& pass) {
    std::vector<std::string> names;
    for (const std::string& name : pass.columns)
      if (name == kTime && (!reader_.points_.has(kTime) || (pass.first_time_s && !reader_.is_imported_)))
        wants_time_ = true;
      else
        names.push_back(name);
    if (wants_time_) names.emplace_back(kPulse);
    if (reads_status_) names.emplace_back(kStatus);
    return names;
  }

  void select(std::size_t count, PointBatch& batch) {
    batch.selected.clear();
    for (std::size_t i = 0; i < count; ++i) {
      if (reads_status_ && !is_return(PointStatus{status_[i]})) continue;
      if (seen_++ % pass_.selection.every == 0) batch.selected.push_back(static_cast<std::uint32_t>(i));
    }
  }

  [[nodiscard]] std::size_t time_column() const {
    return static_cast<std::size_t>(std::find(pass_.columns.begin(), pass_.columns.end(), kTime) -
                                    pass_.columns.begin());
  }

  /// The times that imported points have themselves.
  void shift_times(PointBatch& batch) const {
    const std::size_t c = time_column();
    if (c == pass_.columns.size()) return;
    for (double& t : std::get<std::vector<double>>(batch.columns[c]))
      t = t - reader_.pulse_times_.epoch_s + *pass_.first_time_s;
  }

  void look_up_times(PointBatch& batch) const {
    const std::size_t c = time_column();
    if (!std::holds_alternative<std::vector<double>>(batch.columns[c]))
      batch.columns[c] = std::vector<double>();
    auto& times = std::get<std::vector<double>>(batch.columns[c]);
    times.resize(pulse_.size());
    for (const std::uint32_t i : batch.selected) {
      const std::int32_t pulse = pulse_[i];
      if (pulse < 0 || static_cast<std::size_t>(pulse) >= reader_.stored_times_s_.size())
        fail(batch, kPulse, i, "is " + std::to_string(pulse) + ", which /pulses does not have");
      times[i] = time(static_cast<std::size_t>(pulse));
    }
  }

  [[nodiscard]] double time(std::size_t pulse) const {
    return pass_.first_time_s ? *pass_.first_time_s + reader_.pulse_times_.since_s[pulse]
                              : reader_.stored_times_s_[pulse];
  }

  /// The column of this name; null if the pass has none.
  [[nodiscard]] std::vector<double>* column_in(PointBatch& batch, const char* name) const {
    const auto found = std::ranges::find(pass_.columns, name);
    return found == pass_.columns.end()
               ? nullptr
               : &std::get<std::vector<double>>(
                     batch.columns[static_cast<std::size_t>(found - pass_.columns.begin())]);
  }

  /// Brings the estimated and the true positions to the map.
  void place(PointBatch& batch) const {
    for (const std::size_t first : {std::size_t{0}, std::size_t{3}}) {
      std::vector<double>* const x = column_in(batch, name_of(kCoordinates[first]));
      std::vector<double>* const y = column_in(batch, name_of(kCoordinates[first + 1]));
      std::vector<double>* const z = column_in(batch, name_of(kCoordinates[first + 2]));
      if (reader_.map_->map_point && (x == nullptr) != (y == nullptr))
        throw UsageError("--columns: each coordinate of this map depends on x and y: name " +
                         std::string(name_of(kCoordinates[first])) + " and " +
                         name_of(kCoordinates[first + 1]) + ", or give --frame site");
      for (const std::uint32_t row : batch.selected) {
        const SitePoint site{x != nullptr ? (*x)[row] : 0, y != nullptr ? (*y)[row] : 0};
        const MapPoint at = reader_.map_->at(site);
        if (std::isfinite(site.x_m + site.y_m) && !std::isfinite(at.x + at.y))
          fail(batch, name_of(kCoordinates[first]), row,
               "of a point lies outside its map projection: give --frame site");
        if (x != nullptr) (*x)[row] = at.x;
        if (y != nullptr) (*y)[row] = at.y;
        if (z != nullptr) (*z)[row] = reader_.map_->height_at((*z)[row]);
      }
    }
  }

  void require_finite(const PointBatch& batch) const {
    for (std::size_t c = 0; c < pass_.finite_columns; ++c)
      for (const std::uint32_t i : batch.selected)
        if (!std::isfinite(batch.real(c)[i])) fail(batch, pass_.columns[c], i, "of a return is not finite");
  }

  [[noreturn]] void fail(const PointBatch& batch, const std::string& column, std::size_t row,
                         const std::string& what) const {
    reader_.file_.fail("/points/" + column + "[" + std::to_string(batch.first_row + row) + "] " + what);
  }

  const PointReader& reader_;
  const Pass& pass_;
  bool wants_time_ = false;
  bool reads_status_;
  ColumnReader columns_;
  std::size_t seen_ = 0;
  std::vector<std::int32_t> pulse_;
  std::vector<std::int8_t> status_;
};

std::vector<std::string> position_columns(const std::string& position) {
  const auto* const first = kCoordinates.begin() + (position == "true" ? 3 : 0);
  return {name_of(first[0]), name_of(first[1]), name_of(first[2])};
}

void PointReader::read(const Pass& pass, const std::function<void(const PointBatch& batch)>& use,
                       const ProgressCallback& progress) const {
  for (const std::string& name : pass.columns) static_cast<void>(column(name));
  BatchSource source(*this, pass);
  std::array<PointBatch, 2> slots;
  const std::size_t count = (row_count_ + kBatchRows - 1) / kBatchRows;
  read_ahead(
      count, slots.size(),
      [&](std::size_t i, std::size_t slot) {
        const std::size_t begin = i * kBatchRows;
        source.read(begin, std::min(kBatchRows, row_count_ - begin), slots[slot]);
      },
      [&](std::size_t i, std::size_t slot) {
        use(slots[slot]);
        report(progress, static_cast<double>(i + 1) / static_cast<double>(count));
      });
}

void write_points(const PointReader& points, const PointReader::Pass& pass, const EncodeRows& encode,
                  ByteSink& sink, const ProgressCallback& progress) {
  std::vector<std::string> pieces;
  const auto write_batch = [&](const PointBatch& batch) {
    const std::span<const std::uint32_t> rows = batch.selected;
    const std::size_t count = (rows.size() + kPieceRows - 1) / kPieceRows;
    if (pieces.size() < count) pieces.resize(count);
    parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        pieces[i].clear();
        const std::size_t first = i * kPieceRows;
        encode(batch, rows.subspan(first, std::min(kPieceRows, rows.size() - first)), pieces[i]);
      }
    });
    for (std::size_t i = 0; i < count; ++i) sink.write(pieces[i]);
  };
  points.read(pass, write_batch, progress);
}

}  // namespace landfall
