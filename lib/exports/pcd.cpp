// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D417
#include "exports/pcd.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"

namespace landfall {
namespace {

struct PcdType {
  char letter;
  int bytes;
};

PcdType pcd_type(h5::Type type) {
  switch (type) {
    case h5::Type::int8:
      return {'I', 1};
    case h5::Type::int32:
      return {'I', 4};
    case h5::Type::float32:
      return {'F', 4};
    default:
      return {'F', 8};
  }
}

double rounding_m(const PointBatch& batch, std::span<const std::uint32_t> rows) {
  double largest_m = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::uint32_t row : rows) {
      const double value = batch.real(axis)[row];
      largest_m = std::max(largest_m, std::abs(value - static_cast<double>(static_cast<float>(value))));
    }
  return largest_m;
}

}  // namespace

std::string pcd_header(const std::vector<PointProperty>& properties, std::size_t count,
                       const std::string& file_id) {
  std::string header =
      "# .PCD v0.7 - Point Cloud Data file format\n"
      "# landfall points: metres, x right, y up on the map, z up\n"
      "# file_id " +
      file_id + "\n";
  std::string fields = "FIELDS";
  std::string sizes = "SIZE";
  std::string types = "TYPE";
  std::string counts = "COUNT";
  for (const auto& [column, name, type] : properties) {
    const auto [letter, bytes] = pcd_type(type);
    header += "# " + name + ": " + column.name + ", " + column.long_name + ", unit " + column.units + "\n";
    fields += " " + name;
    sizes += " " + std::to_string(bytes);
    types += std::string(" ") + letter;
    counts += " 1";
  }
  const std::string number = std::to_string(count);
  return header + "VERSION 0.7\n" + fields + "\n" + sizes + "\n" + types + "\n" + counts + "\nWIDTH " +
         number + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\nDATA binary\n";
}

double write_points_pcd(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                        const ProgressCallback& progress) {
  const std::vector<PointProperty> properties = point_properties(points, pass, h5::Type::float32);
  sink.write(pcd_header(properties, points.count(pass.selection), points.file().file_id()));
  const EncodeRows encode = encoder_of(properties);
  std::atomic<double> largest_m = 0;
  write_points(
      points, pass,
      [&](const PointBatch& batch, std::span<const std::uint32_t> rows, std::string& out) {
        const double mine_m = rounding_m(batch, rows);
        double before_m = largest_m;
        while (mine_m > before_m && !largest_m.compare_exchange_weak(before_m, mine_m)) {
        }
        encode(batch, rows, out);
      },
      sink, progress);
  return largest_m;
}

}  // namespace landfall
