// SPDX-License-Identifier: GPL-3.0-or-later
// /features lists the positions and sizes of objects, not all of their parameters: those of listed objects
// are in `config_json`, those of patterns follow from it and the seed. The ground under a centre is
// evaluated in the cell's own coordinates from the origin of the frame, so that a terrain made in parts
// has the same elevations under its features, to the bit.
#include "files/feature_file.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>

#include "base/joined.h"
#include "hdf5/table.h"

namespace landfall {
namespace {

constexpr const char* kGroup = "features";

std::vector<ColumnSpec> feature_columns() {
  std::vector<std::int8_t> values(feature_kinds().size());
  std::iota(values.begin(), values.end(), std::int8_t{0});
  const h5::Type real = h5::Type::float64;
  return {{"x", real, "m", "x of the object's centre in the DEM frame"},
          {"y", real, "m", "y of the object's centre in the DEM frame"},
          {"ground", real, "m", "elevation of the ground under the centre"},
          {"diameter", real, "m", "greatest extent along the ground"},
          {"height", real, "m", "height above the ground, negative for depths"},
          {"yaw", real, "rad", "direction of the greatest extent, counter-clockwise from +x"},
          {"kind", h5::Type::int8, "1", "kind of the object", values, joined(feature_kinds(), " ")},
          {"pattern", h5::Type::int32, "1", "number of the pattern that the object is of, -1 for none"},
          {"number", h5::Type::int64, "1", "number of the object in its pattern or in the list of features"}};
}

/// Some rows, column by column.
struct FeatureColumns {
  std::array<std::vector<double>, 6> reals;  ///< x, y, ground, diameter, height, yaw
  std::vector<std::int8_t> kind;
  std::vector<std::int32_t> pattern;
  std::vector<std::int64_t> number;

  void add(const PlacedFeature& placed) {
    const Feature& feature = placed.feature;
    const FeatureSize size = std::visit([](const auto& shape) { return shape.size(); }, feature.shape);
    const std::array<double, 6> values = {
        feature.x_m,     feature.y_m,   placed.ground_m.value_or(std::numeric_limits<double>::quiet_NaN()),
        size.diameter_m, size.height_m, size.yaw_rad};
    for (std::size_t i = 0; i < reals.size(); ++i) reals[i].push_back(values[i]);
    kind.push_back(static_cast<std::int8_t>(feature.shape.index()));
    pattern.push_back(placed.pattern);
    number.push_back(placed.number);
  }
  [[nodiscard]] std::array<ColumnRows, 9> rows() const {
    return {std::span(reals[0]), std::span(reals[1]), std::span(reals[2]),
            std::span(reals[3]), std::span(reals[4]), std::span(reals[5]),
            std::span(kind),     std::span(pattern),  std::span(number)};
  }
};

}  // namespace

void write_features(const LandfallFileWriter& file, const std::vector<PlacedFeature>& features) {
  if (features.empty()) return;
  TableWriter table(file.root(), kGroup, feature_columns(), file.compression());
  for (std::size_t begin = 0; begin < features.size(); begin += kTableChunkRows) {
    FeatureColumns columns;
    const std::size_t end = std::min(features.size(), begin + kTableChunkRows);
    for (std::size_t i = begin; i < end; ++i) columns.add(features[i]);
    table.append(columns.rows());
  }
  table.finish();
}

}  // namespace landfall
