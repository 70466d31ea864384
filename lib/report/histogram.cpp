// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "evaluation/piecewise.h"

namespace landfall::html_report {
namespace {

struct Extremes {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

template <class T>
bool counts(const Grid<T>& layer, const BinMask& region, std::size_t i) {
  return region.values()[i] != 0 && std::isfinite(layer.values()[i]);
}

template <class T>
Extremes extremes(const Grid<T>& layer, const BinMask& region) {
  Extremes all;
  const auto of_piece = [&](std::size_t begin, std::size_t end) {
    Extremes piece;
    for (std::size_t i = begin; i < end; ++i) {
      if (!counts(layer, region, i)) continue;
      piece.low = std::min(piece.low, static_cast<double>(layer.values()[i]));
      piece.high = std::max(piece.high, static_cast<double>(layer.values()[i]));
    }
    return piece;
  };
  for (const Extremes& piece : by_piece(layer.spec().size(), of_piece)) {
    all.low = std::min(all.low, piece.low);
    all.high = std::max(all.high, piece.high);
  }
  return all;
}

}  // namespace

template <class T>
Histogram histogram(const Grid<T>& layer, const BinMask& region, std::size_t classes) {
  const Extremes found = extremes(layer, region);
  if (found.low > found.high) return {};
  if (found.low == found.high) classes = 1;
  const double per_class = static_cast<double>(classes) / (found.high - found.low);
  const auto of_piece = [&](std::size_t begin, std::size_t end) {
    std::vector<std::int64_t> count(classes, 0);
    for (std::size_t i = begin; i < end; ++i) {
      if (!counts(layer, region, i)) continue;
      const double position = (static_cast<double>(layer.values()[i]) - found.low) * per_class;
      ++count[classes == 1 ? 0 : std::min(static_cast<std::size_t>(position), classes - 1)];
    }
    return count;
  };
  Histogram result{found.low, found.high, std::vector<std::int64_t>(classes, 0)};
  for (const std::vector<std::int64_t>& piece : by_piece(layer.spec().size(), of_piece))
    for (std::size_t k = 0; k < classes; ++k) result.count[k] += piece[k];
  return result;
}

template Histogram histogram(const Grid<double>&, const BinMask&, std::size_t);
template Histogram histogram(const Grid<float>&, const BinMask&, std::size_t);

}  // namespace landfall::html_report
