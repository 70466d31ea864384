// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/feature_file.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <sstream>

#include "hdf5/table.h"

namespace landfall {
namespace {

constexpr const char* kGroup = "features";
constexpr std::size_t kMaxRows = 100'000'000;

std::vector<ColumnSpec> feature_columns() {
  std::string meanings;
  for (const std::string& kind : feature_kinds()) meanings += (meanings.empty() ? "" : " ") + kind;
  std::vector<std::int8_t> values(feature_kinds().size());
  std::iota(values.begin(), values.end(), std::int8_t{0});
  const h5::Type real = h5::Type::float64;
  return {{"x", real, "m", "x of the object's centre in the DEM frame"},
          {"y", real, "m", "y of the object's centre in the DEM frame"},
          {"ground", real, "m", "elevation of the ground under the centre"},
          {"diameter", real, "m", "greatest extent along the ground"},
          {"height", real, "m", "height above the ground, negative for depths"},
          {"yaw", real, "rad", "direction of the greatest extent, counter-clockwise from +x"},
          {"kind", h5::Type::int8, "1", "kind of the object", values, meanings},
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

template <class T>
std::vector<T> read_column(const TableReader& table, const std::string& name, std::size_t row_count) {
  if (table.row_count(name) != row_count)
    table.fail_reading(name, "it has " + std::to_string(table.row_count(name)) + " rows, x has " +
                                 std::to_string(row_count));
  std::vector<T> values(row_count);
  table.read(name, 0, std::span(values));
  return values;
}

std::vector<std::string> kinds_of(const TableReader& table) {
  const h5::Handle column = table.open("kind");
  std::istringstream words(h5::read_text_attribute(column.get(), "flag_meanings").value_or(""));
  std::vector<std::string> kinds;
  for (std::string word; words >> word;) kinds.push_back(word);
  return kinds;
}

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

std::vector<FeatureRecord> read_features(const LandfallFileReader& file) {
  if (!h5::exists(file.root(), kGroup)) return {};
  const TableReader table(file.root(), kGroup, file.name());
  const std::size_t count = table.row_count("x");
  if (count > kMaxRows) table.fail_reading("x", std::to_string(count) + " rows are more than 10^8");
  const std::vector<std::string> kinds = kinds_of(table);
  const auto kind = read_column<std::int8_t>(table, "kind", count);
  const auto pattern = read_column<std::int32_t>(table, "pattern", count);
  const auto number = read_column<std::int64_t>(table, "number", count);
  std::array<std::vector<double>, 6> reals;
  constexpr std::array kReals = {"x", "y", "ground", "diameter", "height", "yaw"};
  for (std::size_t i = 0; i < reals.size(); ++i) reals[i] = read_column<double>(table, kReals[i], count);
  std::vector<FeatureRecord> records;
  records.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (kind[i] < 0 || static_cast<std::size_t>(kind[i]) >= kinds.size())
      table.fail_reading("kind", "row " + std::to_string(i) + " has the value " + std::to_string(kind[i]) +
                                     ", which flag_meanings does not list");
    records.push_back({kinds[static_cast<std::size_t>(kind[i])],
                       reals[0][i],
                       reals[1][i],
                       reals[2][i],
                       {reals[3][i], reals[4][i], reals[5][i]},
                       pattern[i],
                       number[i]});
  }
  return records;
}

}  // namespace landfall
