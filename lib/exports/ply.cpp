// SPDX-License-Identifier: GPL-3.0-or-later
// PLY keeps the stored types, although CloudCompare and ParaView convert to float32: the file itself is
// lossless.
#include "exports/ply.h"

#include "base/number_text.h"
#include "returns/columns.h"

namespace landfall {
namespace {

const char* ply_type(h5::Type type) {
  switch (type) {
    case h5::Type::int8:
      return "char";
    case h5::Type::int32:
      return "int";
    case h5::Type::float32:
      return "float";
    default:
      return "double";  // PLY has no 64-bit integer
  }
}

std::string property_name(const ContentInfo& column) {
  return "scalar_" + (column.name == name_of(&PointColumns::range_measured) ? "range_meas" : column.name);
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

}  // namespace

std::string ply_header(const std::vector<ContentInfo>& columns, std::size_t count,
                       const std::string& file_id) {
  std::string header =
      "ply\nformat binary_little_endian 1.0\n"
      "comment landfall points: metres, x right, y up on the map, z up\n"
      "comment file_id " +
      file_id + "\n";
  const auto is_place = [](std::size_t c) { return c < 3; };
  const auto name_of = [&](std::size_t c) {
    return is_place(c) ? std::string(1, "xyz"[c]) : property_name(columns[c]);
  };
  for (std::size_t c = 0; c < columns.size(); ++c)
    header += "comment " + name_of(c) + ": " + columns[c].name + ", " + columns[c].long_name + ", unit " +
              columns[c].units + "\n";
  header += "element vertex " + std::to_string(count) + "\n";
  for (std::size_t c = 0; c < columns.size(); ++c)
    header += std::string("property ") + (is_place(c) ? "double" : ply_type(columns[c].type)) + " " +
              name_of(c) + "\n";
  return header + "end_header\n";
}

void write_points_ply(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress) {
  std::vector<ContentInfo> columns;
  std::vector<h5::Type> types;
  for (const std::string& name : pass.columns) {
    columns.push_back(points.column(name));
    types.push_back(types.size() < 3 ? h5::Type::float64 : columns.back().type);
  }
  sink.write(ply_header(columns, points.count(pass.selection), points.file().file_id()));
  const auto encode = [&types](const PointBatch& batch, std::span<const std::uint32_t> rows,
                               std::string& out) {
    for (const std::uint32_t row : rows)
      for (std::size_t c = 0; c < types.size(); ++c) append_value(out, batch, c, row, types[c]);
  };
  write_points(points, pass, encode, sink, progress);
}

}  // namespace landfall
