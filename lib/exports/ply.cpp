// SPDX-License-Identifier: GPL-3.0-or-later
// PLY keeps the stored types, although CloudCompare and ParaView convert to float32: the file itself is
// lossless.
#include "exports/ply.h"

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
      return "double";
  }
}

}  // namespace

std::string ply_header(const std::vector<PointProperty>& properties, std::size_t count,
                       const std::string& file_id) {
  std::string header =
      "ply\nformat binary_little_endian 1.0\n"
      "comment landfall points: metres, x right, y up on the map, z up\n"
      "comment file_id " +
      file_id + "\n";
  for (const auto& [column, name, type] : properties)
    header +=
        "comment " + name + ": " + column.name + ", " + column.long_name + ", unit " + column.units + "\n";
  header += "element vertex " + std::to_string(count) + "\n";
  for (const PointProperty& property : properties)
    header += std::string("property ") + ply_type(property.type) + " " + property.name + "\n";
  return header + "end_header\n";
}

void write_points_ply(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress) {
  const std::vector<PointProperty> properties = point_properties(points, pass, h5::Type::float64);
  sink.write(ply_header(properties, points.count(pass.selection), points.file().file_id()));
  write_points(points, pass, encoder_of(properties), sink, progress);
}

}  // namespace landfall
