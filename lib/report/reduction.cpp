// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D154
#include "report/reduction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raster/by_rows.h"

namespace landfall::html_report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Chooses one of two values of a block.
double chosen(double a, double b, Rule rule) {
  switch (rule) {
    case Rule::extreme:
      return std::abs(b) > std::abs(a) || (b == -a && b > a) ? b : a;
    case Rule::largest:
      return std::max(a, b);
    case Rule::least:
      return std::min(a, b);
    case Rule::any_bit:
      return static_cast<double>(static_cast<std::int64_t>(a) | static_cast<std::int64_t>(b));
    case Rule::mean:
      return a + b;
  }
  return kNan;
}

template <class T>
double of_block(const Grid<T>& layer, BinIndex first, std::int64_t factor, Rule rule) {
  const BinIndex end{std::min(first.row + factor, layer.spec().rows),
                     std::min(first.col + factor, layer.spec().cols)};
  double result = kNan;
  std::int64_t count = 0;
  for (std::int64_t row = first.row; row < end.row; ++row) {
    for (std::int64_t col = first.col; col < end.col; ++col) {
      const auto value = static_cast<double>(layer.at({row, col}));
      if (!std::isfinite(value)) continue;
      result = count == 0 ? value : chosen(result, value, rule);
      ++count;
    }
  }
  return rule == Rule::mean && count > 0 ? result / static_cast<double>(count) : result;
}

}  // namespace

std::int64_t reduction_factor(const GridSpec& spec, std::int64_t max_cells) {
  return std::max<std::int64_t>(1, (std::max(spec.rows, spec.cols) + max_cells - 1) / max_cells);
}

template <class T>
ReducedMap reduce(const Grid<T>& layer, std::int64_t factor, Rule rule) {
  const GridSpec& spec = layer.spec();
  ReducedMap map{factor, (spec.rows + factor - 1) / factor, (spec.cols + factor - 1) / factor, {}};
  map.cells.resize(static_cast<std::size_t>(map.rows * map.cols));
  by_rows(map.rows, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < map.cols; ++col)
      map.cells[static_cast<std::size_t>(row * map.cols + col)] =
          of_block(layer, {row * factor, col * factor}, factor, rule);
  });
  return map;
}

template ReducedMap reduce(const Grid<double>&, std::int64_t, Rule);
template ReducedMap reduce(const Grid<float>&, std::int64_t, Rule);
template ReducedMap reduce(const Grid<std::int32_t>&, std::int64_t, Rule);
template ReducedMap reduce(const Grid<std::int8_t>&, std::int64_t, Rule);

}  // namespace landfall::html_report
