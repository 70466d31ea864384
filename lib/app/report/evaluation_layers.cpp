// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/evaluation_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/report/worst_footprints.h"
#include "base/numerics/portable_math.h"
#include "chain/evaluation/piecewise.h"

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

constexpr std::size_t kHistogramClasses = 1000;

float larger(float a, double b) {
  const auto share = static_cast<float>(b);
  return std::isnan(a) || share > a ? share : a;
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

ReportLayers::ReportLayers(const GridSpec& spec, const EvaluationParameters& parameters,
                           std::int64_t max_cells)
    : spec_(spec), limits_(parameters.limits), factor_(reduction_factor(spec, max_cells)) {}

template <class T>
void ReportLayers::add(ReportLayer layer, const Grid<T>& values) {
  layer.limit = limit_of_layer(limits_, layer.name);
  layers_.push_back(reduced_layer(std::move(layer), values, factor_));
}

void ReportLayers::take(const DemLayers& dem) {
  add(described("dem", "z_est"), dem.z_est);
  if (dem.truth) add(described("dem", "z_true"), dem.truth->z);
}

void ReportLayers::take(const Grid<std::int32_t>& count) { add(described("dem", "count"), count); }

void ReportLayers::take(const CoverageLayers& layers) {
  region_ = layers.in_region;
  add(described("evaluation", "in_region"), layers.in_region);
  add(described("evaluation", "invalid"), layers.invalid);
}

void ReportLayers::take(Axis axis, const AxisLayers& layers) {
  const std::string name = axis == Axis::x ? "x" : axis == Axis::y ? "y" : "z";
  add(described("evaluation", "e_" + name), layers.error);
  add(described("evaluation", "abs_" + name), layers.absolute);
  add(described("evaluation", "rel_" + name), layers.relative);
  histograms_[static_cast<std::size_t>(axis)] = {histogram(layers.error, region_, kHistogramClasses),
                                                 histogram(layers.relative, region_, kHistogramClasses)};
  add_shares(axis, name, layers);
}

void ReportLayers::add_shares(Axis axis, const std::string& name, const AxisLayers& layers) {
  const double limit_m = *limit_of_layer(limits_, "rel_" + name);
  if (shares_.values().empty()) shares_ = Grid<float>(spec_, std::numeric_limits<float>::quiet_NaN());
  for_each_index(spec_.size(), [&](std::size_t i) {
    shares_.values()[i] = larger(shares_.values()[i], share_of_limit(layers.relative.values()[i], limit_m));
  });
  if (axis == Axis::x) absolute_x_ = layers.absolute;
  if (axis != Axis::y) return;
  const double horizontal_limit_m = *limit_of_layer(limits_, "abs_" + name);
  for_each_index(spec_.size(), [&](std::size_t i) {
    const double horizontal_m = portable::hypot(absolute_x_.values()[i], layers.absolute.values()[i]);
    shares_.values()[i] = larger(shares_.values()[i], share_of_limit(horizontal_m, horizontal_limit_m));
  });
  absolute_x_ = {};
}

void ReportLayers::take(const Grid<std::int8_t>& fail) {
  add(described("evaluation", "fail"), fail);
  const auto of_piece = [&](std::size_t begin, std::size_t end) {
    FailCounts counts{};
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t bit = 0; bit < counts.size(); ++bit) counts[bit] += fail.values()[i] >> bit & 1;
    return counts;
  };
  for (const FailCounts& piece : by_piece(spec_.size(), of_piece))
    for (std::size_t bit = 0; bit < piece.size(); ++bit) fail_counts_[bit] += piece[bit];
}

}  // namespace landfall::html_report
