// SPDX-License-Identifier: GPL-3.0-or-later
#include "exports/las.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/number_text.h"
#include "returns/columns.h"

namespace landfall {
namespace {

constexpr double kMaxSteps = 0x1p31 - 1024;  // room for the rounding of the centre
constexpr std::size_t kMaxPoints = 0xffffffffU;
constexpr std::size_t kRecordHeaderBytes = 54;

/// A text field of fixed length, filled with zeros.
void append_text(std::string& out, std::string text, std::size_t length) {
  text.resize(length, '\0');
  out += text;
}

/// Columns of a pass over the points: coordinates, then time, then status.
constexpr std::size_t kTimeColumn = 3;
constexpr std::size_t kStatusColumn = 4;

void append_point(std::string& out, const LasGrid& grid, const PointBatch& batch, std::size_t row) {
  for (std::size_t axis = 0; axis < 3; ++axis) append_raw(out, grid.stored(batch.real(axis)[row], axis));
  const bool is_false = batch.number(kStatusColumn, row) == static_cast<double>(PointStatus::false_return);
  append_raw(out, std::uint16_t{0});               // intensity
  append_raw(out, std::uint8_t{1U | (1U << 3U)});  // return 1 of 1
  append_raw(out, static_cast<std::uint8_t>(is_false ? 7 : 1));
  append_raw(out, std::uint8_t{0});   // scan angle
  append_raw(out, std::uint8_t{0});   // user data
  append_raw(out, std::uint16_t{0});  // point source
  append_raw(out, batch.real(kTimeColumn)[row]);
}

struct Extent {
  PointBox box;
  std::size_t count = 0;
};

Extent extent_of(const PointReader& points, const PointReader::Pass& pass, const ProgressCallback& progress) {
  Extent extent;
  points.read(
      pass,
      [&extent](const PointBatch& batch) {
        extent.count += batch.selected.size();
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

}  // namespace

LasGrid LasGrid::fitting(const PointBox& box, const std::string& file) {
  LasGrid grid;
  double half = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.offset_m[axis] = std::round(box.low[axis] / 2 + box.high[axis] / 2);
    half = std::max({half, box.high[axis] - grid.offset_m[axis], grid.offset_m[axis] - box.low[axis]});
  }
  for (const double scale : {1e-6, 1e-5, 1e-4}) {
    grid.scale_m = scale;
    if (half <= scale * kMaxSteps) return grid;
  }
  throw FormatError(file + ": points reach " + number_text(half) + " m from their centre; LAS allows " +
                    number_text(std::floor(1e-4 * kMaxSteps)) +
                    " m at 0.1 mm; export .ply, or remove the outliers");
}

std::int32_t LasGrid::stored(double coordinate_m, std::size_t axis) const {
  return static_cast<std::int32_t>(std::llround((coordinate_m - offset_m[axis]) / scale_m));
}

std::string las_header(const LasContent& content) {
  std::string out = "LASF";
  append_raw(out, std::uint16_t{0});  // file source
  append_raw(out, std::uint16_t{0});  // global encoding: times count from the scan's own zero
  append_text(out, "", 16);           // project
  append_raw(out, std::uint8_t{1});
  append_raw(out, std::uint8_t{2});
  append_text(out, "landfall scan", 32);  // system identifier
  append_text(out, content.software, 32);
  append_raw(out, std::uint16_t{0});  // day of the year
  append_raw(out, std::uint16_t{0});  // year
  append_raw(out, static_cast<std::uint16_t>(kLasHeaderBytes));
  append_raw(out, static_cast<std::uint32_t>(kLasHeaderBytes + kRecordHeaderBytes + content.file_id.size()));
  append_raw(out, std::uint32_t{1});  // variable-length records
  append_raw(out, std::uint8_t{1});   // point format
  append_raw(out, static_cast<std::uint16_t>(kLasPointBytes));
  append_raw(out, static_cast<std::uint32_t>(content.count));
  append_raw(out, static_cast<std::uint32_t>(content.count));  // first returns
  append_text(out, "", 16);                                    // second to fifth returns
  for (int axis = 0; axis < 3; ++axis) append_raw(out, content.grid.scale_m);
  for (const double offset : content.grid.offset_m) append_raw(out, offset);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double bound : {content.box.high[axis], content.box.low[axis]})
      append_raw(out, content.grid.read_back(content.grid.stored(bound, axis), axis));
  append_raw(out, std::uint16_t{0});
  append_text(out, "landfall", 16);
  append_raw(out, std::uint16_t{1});
  append_raw(out, static_cast<std::uint16_t>(content.file_id.size()));
  append_text(out, "file_id of the scan", 32);
  return out + content.file_id;
}

void write_points_las(const PointReader& points, const std::string& position, std::size_t every,
                      const std::string& software, ByteSink& sink, const ProgressCallback& progress) {
  static_cast<void>(points.column(name_of(&PulseColumns::t)));
  PointReader::Pass pass{position_columns(position), {true, every}, 3};
  const Extent extent = extent_of(points, pass, [&](double f) { report(progress, f / 4); });
  if (extent.count == 0) points.file().fail("holds no return");
  if (extent.count > kMaxPoints)
    points.file().fail("has " + std::to_string(extent.count) +
                       " points; LAS 1.2 holds 4294967295: use --every, or export .ply");
  const LasContent content{LasGrid::fitting(extent.box, points.file().name()), extent.box, extent.count,
                           software, points.file().file_id().substr(0, 256)};
  sink.write(las_header(content));
  pass.columns.insert(pass.columns.end(), {name_of(&PulseColumns::t), name_of(&PointColumns::status)});
  const auto encode = [&content](const PointBatch& batch, std::span<const std::uint32_t> rows,
                                 std::string& out) {
    for (const std::uint32_t row : rows) append_point(out, content.grid, batch, row);
  };
  write_points(points, pass, encode, sink, [&](double f) { report(progress, (1 + 3 * f) / 4); });
}

}  // namespace landfall
