// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D417
#include "app/exports/point_clouds.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/core/parallel.h"
#include "base/returns/columns.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "chain/terrain/site_wkt.h"

namespace landfall {
namespace {

std::string property_name(const std::string& column) {
  return "scalar_" + (column == name_of(&PointColumns::range_measured) ? "range_meas" : column);
}

/// A type of numbers in PLY and PCD files.
struct WrittenType {
  h5::Type type;
  const char* ply;
  const char* pcd;
};

/// That of a column; the last for a type that these files do not have.
const WrittenType& written_as(h5::Type type) {
  static constexpr std::array kTypes = {
      WrittenType{h5::Type::int8, "char", "I"}, WrittenType{h5::Type::int32, "int", "I"},
      WrittenType{h5::Type::float32, "float", "F"}, WrittenType{h5::Type::float64, "double", "F"}};
  const auto* const found = std::ranges::find(kTypes, type, &WrittenType::type);
  return found == kTypes.end() ? kTypes.back() : *found;
}

void append_value(std::string& out, const PointBatch& batch, std::size_t c, std::size_t row, h5::Type type) {
  switch (type) {
    case h5::Type::int8:
      return append_raw(out, std::get<std::vector<std::int8_t>>(batch.columns[c])[row]);
    case h5::Type::int32:
      return append_raw(out, std::get<std::vector<std::int32_t>>(batch.columns[c])[row]);
    case h5::Type::float32:
      return append_raw(out, static_cast<float>(batch.real(c)[row]));
    default:
      return append_raw(out, batch.number(c, row));
  }
}

double rounding_of(const PointBatch& batch, std::span<const std::uint32_t> rows,
                   const std::array<double, 3>& offset) {
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::uint32_t row : rows) {
      const double value = batch.real(axis)[row] - offset[axis];
      largest = std::max(largest, std::abs(value - static_cast<double>(static_cast<float>(value))));
    }
  return largest;
}

/// The comments of a header about the frame, each line after `begin`.
std::string frame_comments(const char* begin, const std::optional<MapFrame>& map) {
  if (!map) return std::string(begin) + "landfall points: metres, x right, y up on the map, z up\n";
  return std::string(begin) + "landfall points: coordinates in " + map->crs_name + ", z up, unit " +
         length_unit_name(map->metres_per_height) + "\n" + begin + "crs " + map->crs_wkt + "\n";
}

/// The properties of a pass, whose first three columns are the position: x, y and z of the type
/// `position`, then the other columns as scalar_NAME of their type in the file. range_measured is named
/// scalar_range_meas because CloudCompare takes a property whose name contains "red" for a colour.
std::vector<PointProperty> point_properties(const PointReader& points, const PointReader::Pass& pass,
                                            h5::Type position) {
  std::vector<PointProperty> properties;
  for (const std::string& name : pass.columns) {
    const ContentInfo column = points.read_column(name);
    if (properties.size() < 3)
      properties.push_back({column, std::string(1, "xyz"[properties.size()]), position});
    else
      properties.push_back({column, property_name(name), written_as(column.type).type});
  }
  return properties;
}

void append_row(std::string& out, const std::vector<PointProperty>& properties, const PointBatch& batch,
                std::uint32_t row, std::size_t first) {
  for (std::size_t c = first; c < properties.size(); ++c)
    append_value(out, batch, c, row, properties[c].type);
}

}  // namespace

std::string ply_header(const std::vector<PointProperty>& properties, std::size_t count,
                       const std::string& file_id, const std::optional<MapFrame>& map) {
  std::string header = "ply\nformat binary_little_endian 1.0\n" + frame_comments("comment ", map) +
                       "comment file_id " + file_id + "\n";
  for (const auto& [column, name, type] : properties)
    header +=
        "comment " + name + ": " + column.name + ", " + column.long_name + ", unit " + column.units + "\n";
  header += "element vertex " + std::to_string(count) + "\n";
  for (const PointProperty& property : properties)
    header += std::string("property ") + written_as(property.type).ply + " " + property.name + "\n";
  return header + "end_header\n";
}

// PLY keeps the stored types, although CloudCompare and ParaView convert to float32: the file itself is
// lossless.
void write_points_ply(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress) {
  const std::vector<PointProperty> properties = point_properties(points, pass, h5::Type::float64);
  sink.write(ply_header(properties, points.count(pass.selection), points.file().file_id(), points.map()));
  const auto encode = [&](const PointBatch& batch, std::span<const std::uint32_t> rows, std::string& out) {
    for (const std::uint32_t row : rows) append_row(out, properties, batch, row, 0);
  };
  write_points(points, pass, encode, sink, progress);
}

std::array<double, 3> pcd_offset(const std::optional<MapFrame>& map) {
  if (!map) return {0, 0, 0};
  return {map->center.x, map->center.y, map->center_height};
}

std::string pcd_header(const std::vector<PointProperty>& properties, std::size_t count,
                       const std::string& file_id, const std::optional<MapFrame>& map) {
  std::string header = "# .PCD v0.7 - Point Cloud Data file format\n" + frame_comments("# ", map) +
                       "# file_id " + file_id + "\n";
  if (map) header += "# x, y and z are relative to the translation of VIEWPOINT\n";
  std::string fields = "FIELDS";
  std::string sizes = "SIZE";
  std::string types = "TYPE";
  std::string counts = "COUNT";
  for (const auto& [column, name, type] : properties) {
    const WrittenType& as = written_as(type);
    header += "# " + name + ": " + column.name + ", " + column.long_name + ", unit " + column.units + "\n";
    fields += " " + name;
    sizes += " " + std::to_string(h5::size_of(as.type));
    types += std::string(" ") + as.pcd;
    counts += " 1";
  }
  const std::string number = std::to_string(count);
  return header + "VERSION 0.7\n" + fields + "\n" + sizes + "\n" + types + "\n" + counts + "\nWIDTH " +
         number + "\nHEIGHT 1\nVIEWPOINT " + joined(pcd_offset(map), " ", coordinate_text) +
         " 1 0 0 0\nPOINTS " + number + "\nDATA binary\n";
}

double write_points_pcd(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                        const ProgressCallback& progress) {
  const std::vector<PointProperty> properties = point_properties(points, pass, h5::Type::float32);
  sink.write(pcd_header(properties, points.count(pass.selection), points.file().file_id(), points.map()));
  const std::array<double, 3> offset = pcd_offset(points.map());
  std::atomic<double> largest = 0;
  write_points(
      points, pass,
      [&](const PointBatch& batch, std::span<const std::uint32_t> rows, std::string& out) {
        const double mine = rounding_of(batch, rows, offset);
        double before = largest;
        while (mine > before && !largest.compare_exchange_weak(before, mine)) {
        }
        for (const std::uint32_t row : rows) {
          for (std::size_t axis = 0; axis < 3; ++axis)
            append_raw(out, static_cast<float>(batch.real(axis)[row] - offset[axis]));
          append_row(out, properties, batch, row, 3);
        }
      },
      sink, progress);
  return largest;
}

}  // namespace landfall
