// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/raster/grid.h"
#include "bins.h"
#include "chain/gridding/accumulator.h"
#include "chain/gridding/layers.h"

namespace landfall {

/// All bins, row-major.
inline std::vector<BinValues> all_values(const Accumulator& map) {
  std::vector<BinValues> values(map.spec().size());
  for (std::int64_t row = 0; row < map.spec().rows; ++row)
    map.values({row, 0}, std::span(values).subspan(map.spec().index({row, 0}),
                                                   static_cast<std::size_t>(map.spec().cols)));
  return values;
}

template <class T, class Value>
Grid<T> layer_of(const Accumulator& map, Value value) {
  Grid<T> layer(map.spec());
  const std::vector<BinValues> values = all_values(map);
  for (std::size_t i = 0; i < values.size(); ++i) layer.values()[i] = static_cast<T>(value(values[i]));
  return layer;
}

inline Grid<double> z_est_layer(const Accumulator& map) {
  return layer_of<double>(map, [](const BinValues& v) { return v.z_est; });
}
inline Grid<double> x_true_layer(const Accumulator& map) {
  return layer_of<double>(map, [](const BinValues& v) { return v.x_true; });
}
inline Grid<double> y_true_layer(const Accumulator& map) {
  return layer_of<double>(map, [](const BinValues& v) { return v.y_true; });
}
inline Grid<double> weight_sum_layer(const Accumulator& map) {
  return layer_of<double>(map, [](const BinValues& v) { return v.weight_sum; });
}
inline Grid<std::int32_t> count_layer(const Accumulator& map) {
  return layer_of<std::int32_t>(map, [](const BinValues& v) { return v.count; });
}
inline Grid<float> x_est_mean_layer(const Accumulator& map) {
  return layer_of<float>(map, [](const BinValues& v) { return v.x_est; });
}
inline Grid<float> y_est_mean_layer(const Accumulator& map) {
  return layer_of<float>(map, [](const BinValues& v) { return v.y_est; });
}
inline Grid<float> t_mean_layer(const Accumulator& map) {
  return layer_of<float>(map, [](const BinValues& v) { return v.t; });
}
inline Grid<float> z_spread_layer(const Accumulator& map) {
  return layer_of<float>(map, [](const BinValues& v) { return v.spread; });
}
inline Grid<double> z_true_layer(const Accumulator& map, const auto& elevation, TruthAt truth_at) {
  Grid<double> layer(map.spec());
  const std::vector<BinValues> values = all_values(map);
  for (const BinIndex bin : bins_of(map.spec())) {
    layer.at(bin) = true_elevation(values[map.spec().index(bin)], map.spec(), bin, elevation, truth_at);
  }
  return layer;
}

}  // namespace landfall
