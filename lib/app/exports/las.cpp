// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D162, D385
#include "app/exports/las.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/core/error.h"
#include "base/returns/columns.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr double kMaxLasSteps = 0x1p31 - 1024;  // room for the rounding of the centre
constexpr std::size_t kMaxPoints = 0xffffffffU;

/// A text field of fixed length, filled with zeros.
void append_text(std::string& out, std::string text, std::size_t length) {
  text.resize(length, '\0');
  out += text;
}

/// Columns of the pass that writes the points: coordinates, status, then the others if the scan has them.
constexpr std::size_t kStatusColumn = 3;

struct OtherColumns {
  std::optional<std::size_t> time, intensity;
};

OtherColumns add_columns(const PointReader& points, std::vector<std::string>& columns) {
  columns.emplace_back(name_of(&PointColumns::status));
  const auto add = [&](const char* name) -> std::optional<std::size_t> {
    if (!points.has(name)) return std::nullopt;
    columns.emplace_back(name);
    return columns.size() - 1;
  };
  const auto time = add(name_of(&PulseColumns::t));
  return {.time = time, .intensity = add(name_of(&PointColumns::intensity))};
}

/// The number of each return, from 1, and of all returns of its pixel, by row of the scan; empty: 1 of 1.
class ReturnNumbers {
 public:
  ReturnNumbers() = default;
  explicit ReturnNumbers(const PointReader& points) {
    if (!points.has(name_of(&PointColumns::return_number))) return;
    const PointReader::Pass pass{{name_of(&PointColumns::return_number)}, {.only_returns = false}, 0};
    points.read(pass, [&](const PointBatch& batch) {
      const auto& rows = std::get<std::vector<std::int8_t>>(batch.columns[0]);
      number_.insert(number_.end(), rows.begin(), rows.end());
    });
    total_ = number_;
    for (std::size_t row = total_.size(); row-- > 1;)
      if (number_[row] > 1) total_[row - 1] = total_[row];
  }

  [[nodiscard]] bool all_fit() const {
    return std::ranges::none_of(number_, [](std::int8_t number) { return number > kMaxReturn; });
  }
  [[nodiscard]] std::uint8_t number(std::size_t row) const { return value(number_, row); }
  [[nodiscard]] std::uint8_t total(std::size_t row) const { return value(total_, row); }

 private:
  static constexpr int kMaxReturn = 5;

  /// In 1 .. 5, also for a file of another program.
  [[nodiscard]] static std::uint8_t value(const std::vector<std::int8_t>& values, std::size_t row) {
    return row < values.size() ? static_cast<std::uint8_t>(std::clamp<int>(values[row], 1, kMaxReturn))
                               : std::uint8_t{1};
  }

  std::vector<std::int8_t> number_, total_;
};

std::uint16_t stored_intensity(double photoelectrons) {
  return photoelectrons > 0 ? static_cast<std::uint16_t>(std::min(std::round(photoelectrons), 65535.0))
                            : std::uint16_t{0};
}

void append_point(std::string& out, const LasGrid& grid, const PointBatch& batch, const OtherColumns& others,
                  const ReturnNumbers& numbers, std::size_t row) {
  for (std::size_t axis = 0; axis < 3; ++axis) append_raw(out, grid.stored(batch.real(axis)[row], axis));
  const bool is_false = batch.number(kStatusColumn, row) == static_cast<double>(PointStatus::false_return);
  const std::size_t in_file = batch.first_row + row;
  append_raw(out, others.intensity ? stored_intensity(batch.real(*others.intensity)[row]) : std::uint16_t{0});
  append_raw(out, static_cast<std::uint8_t>(numbers.number(in_file) | (numbers.total(in_file) << 3U)));
  append_raw(out, static_cast<std::uint8_t>(is_false ? 7 : 1));
  append_raw(out, std::uint8_t{0});   // scan angle
  append_raw(out, std::uint8_t{0});   // user data
  append_raw(out, std::uint16_t{0});  // point source
  if (others.time) append_raw(out, batch.real(*others.time)[row]);
}

struct LasExtent {
  PointBox box;
  std::size_t count = 0;
  std::array<std::size_t, 5> count_by_return{};
};

LasExtent extent_of(const PointReader& points, const PointReader::Pass& pass, const ReturnNumbers& numbers,
                    const ProgressCallback& progress) {
  LasExtent extent;
  points.read(
      pass,
      [&](const PointBatch& batch) {
        extent.count += batch.selected.size();
        for (const std::uint32_t row : batch.selected)
          ++extent.count_by_return[std::size_t{numbers.number(batch.first_row + row)} - 1];
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const std::vector<double>& values = batch.real(axis);
          for (const std::uint32_t row : batch.selected) {
            extent.box.low[axis] = std::min(extent.box.low[axis], values[row]);
            extent.box.high[axis] = std::max(extent.box.high[axis], values[row]);
          }
        }
      },
      progress);
  return extent;
}

/// A variable-length record.
std::string las_record(const char* user, std::uint16_t number, const char* description,
                       const std::string& content) {
  std::string out;
  append_raw(out, std::uint16_t{0});
  append_text(out, user, 16);
  append_raw(out, number);
  append_raw(out, static_cast<std::uint16_t>(content.size()));
  append_text(out, description, 32);
  return out + content;
}

/// The part of the header that LAS 1.4 adds.
void append_las14(std::string& out, const LasContent& content) {
  append_raw(out, std::uint64_t{0});  // waveforms
  append_raw(out, std::uint64_t{0});  // extended records
  append_raw(out, std::uint32_t{0});
  append_raw(out, std::uint64_t{content.count});
  for (const std::size_t count : content.count_by_return) append_raw(out, std::uint64_t{count});
  append_text(out, "", std::size_t{10} * sizeof(std::uint64_t));  // returns 6 to 15
}

}  // namespace

LasGrid LasGrid::fitting(const PointBox& box, const std::string& file, const std::optional<MapFrame>& map) {
  LasGrid grid;
  std::array<double, 3> half{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.offset[axis] = std::round(box.low[axis] / 2 + box.high[axis] / 2);
    half[axis] = std::max(box.high[axis] - grid.offset[axis], grid.offset[axis] - box.low[axis]);
  }
  const std::string unit = map ? map->unit : "m";
  const auto finest = [&](double reach, const std::array<double, 3>& steps) {
    for (const double step : steps)
      if (reach <= step * kMaxLasSteps) return step;
    throw FormatError(file + ": points reach " + number_text(reach) + " " + unit +
                      " from their centre; LAS allows " +
                      number_text(std::floor(steps.back() * kMaxLasSteps)) + " " + unit +
                      "; export .ply, or remove the outliers");
  };
  constexpr std::array kMetres = {1e-6, 1e-5, 1e-4};
  constexpr std::array kDegrees = {1e-9, 1e-8, 1e-7};
  if (map && map->is_geographic) {
    const double planar = finest(std::max(half[0], half[1]), kDegrees);
    grid.scale = {planar, planar, finest(half[2], kMetres)};
  } else {
    grid.scale.fill(finest(std::ranges::max(half), kMetres));
  }
  return grid;
}

std::int32_t LasGrid::stored(double coordinate, std::size_t axis) const {
  return static_cast<std::int32_t>(std::llround((coordinate - offset[axis]) / scale[axis]));
}

std::string las_header(const LasContent& content) {
  constexpr unsigned kCrsIsWkt = 0x10;
  const bool has_crs = !content.crs_wkt.empty();
  std::string records = las_record("landfall", 1, "file_id of the scan", content.file_id);
  if (has_crs) records += las_record("LASF_Projection", 2112, "CRS as WKT", content.crs_wkt + '\0');
  const std::size_t header_bytes = has_crs ? kLas14HeaderBytes : kLasHeaderBytes;
  std::string out = "LASF";
  append_raw(out, std::uint16_t{0});  // file source
  append_raw(out, static_cast<std::uint16_t>((content.time == LasTime::gps ? 1U : 0U) |
                                             (has_crs ? kCrsIsWkt : 0U)));  // global encoding
  append_text(out, "", 16);                                                 // project
  append_raw(out, std::uint8_t{1});
  append_raw(out, static_cast<std::uint8_t>(has_crs ? 4 : 2));
  append_text(out, "landfall scan", 32);  // system identifier
  append_text(out, content.software, 32);
  append_raw(out, std::uint16_t{0});  // day of the year
  append_raw(out, std::uint16_t{0});  // year
  append_raw(out, static_cast<std::uint16_t>(header_bytes));
  append_raw(out, static_cast<std::uint32_t>(header_bytes + records.size()));
  append_raw(out, std::uint32_t{has_crs ? 2U : 1U});                      // variable-length records
  append_raw(out, static_cast<std::uint8_t>(content.has_times ? 1 : 0));  // point format
  append_raw(out, static_cast<std::uint16_t>(content.has_times ? kLasPointBytes : kLasUntimedPointBytes));
  append_raw(out, static_cast<std::uint32_t>(content.count));
  for (const std::size_t count : content.count_by_return) append_raw(out, static_cast<std::uint32_t>(count));
  for (const double scale : content.grid.scale) append_raw(out, scale);
  for (const double offset : content.grid.offset) append_raw(out, offset);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double bound : {content.box.high[axis], content.box.low[axis]})
      append_raw(out, content.grid.read_back(content.grid.stored(bound, axis), axis));
  if (has_crs) append_las14(out, content);
  return out + records;
}

void require_gps_times(const PointReader& points) {
  static_cast<void>(points.column(name_of(&PulseColumns::t)));
  if (points.is_imported())
    throw UsageError("--time gps: " + points.file().name() +
                     " is imported, and the clock of its times is that of its source: use --time scan");
  const std::vector<double>& since_s = points.pulse_times().since_s;
  const double min_s = since_s.empty() ? 0 : *std::ranges::min_element(since_s);
  if (points.pulse_times().epoch_s + min_s < 0)
    throw UsageError("--time gps: " + points.file().name() + ": a pulse is at " +
                     number_text(points.pulse_times().epoch_s + min_s) +
                     " s; the GPS clock begins at 0 s (1980-01-06): use --time scan");
}

std::vector<std::string> write_points_las(const PointReader& points, const LasRequest& request,
                                          ByteSink& sink, const ProgressCallback& progress) {
  if (request.time == LasTime::gps) require_gps_times(points);
  PointReader::Pass pass{position_columns(request.position), {true, request.every}, 3};
  pass.first_time_s = request.time == LasTime::gps ? points.pulse_times().epoch_s - 1e9 : 0;
  const ReturnNumbers numbers(points);
  const LasExtent extent = extent_of(points, pass, numbers, [&](double f) { report(progress, f / 4); });
  if (extent.count == 0) points.file().fail("holds no return");
  if (extent.count > kMaxPoints)
    points.file().fail("has " + std::to_string(extent.count) +
                       " points; LAS 1.2 holds 4294967295: use --every, or export .ply");
  const OtherColumns others = add_columns(points, pass.columns);
  const std::optional<MapFrame>& map = points.map();
  const LasContent content{LasGrid::fitting(extent.box, points.file().name(), map),
                           extent.box,
                           extent.count,
                           extent.count_by_return,
                           request.software,
                           request.time,
                           others.time.has_value(),
                           points.file().file_id().substr(0, 256),
                           map ? map->crs_wkt : ""};
  sink.write(las_header(content));
  const auto encode = [&](const PointBatch& batch, std::span<const std::uint32_t> rows, std::string& out) {
    for (const std::uint32_t row : rows) append_point(out, content.grid, batch, others, numbers, row);
  };
  write_points(points, pass, encode, sink, [&](double f) { report(progress, (1 + 3 * f) / 4); });
  std::vector<std::string> remarks;
  if (!others.time) remarks.emplace_back("its points have no times");
  if (points.is_imported() && others.intensity)
    remarks.emplace_back("intensities are rounded to integers of 0 to 65535");
  if (!numbers.all_fit()) remarks.emplace_back("numbers of returns above 5 are written as 5");
  return remarks;
}

}  // namespace landfall
