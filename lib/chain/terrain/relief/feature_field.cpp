// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D15
#include "chain/terrain/relief/feature_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>

#include "base/core/error.h"
#include "base/core/parallel.h"

namespace landfall {
namespace {

constexpr std::size_t kRowGrain = 16;

FeatureRole role_of(const Feature& feature) {
  return std::visit([](const auto& shape) { return shape.kRole; }, feature.shape);
}

/// "features/3", "patterns/0 feature 17".
std::string name_of(const PlacedFeature& placed) {
  const std::string number = std::to_string(placed.number);
  if (placed.pattern < 0) return "features/" + number;
  return "patterns/" + std::to_string(placed.pattern) + " feature " + number;
}

std::string centre_of(const PlacedFeature& placed) {
  std::ostringstream text;
  text << name_of(placed) << ": its centre (" << placed.feature.x_m << ", " << placed.feature.y_m
       << ") m is ";
  return text.str();
}

bool on_grid(const GridSpec& grid, const Feature& feature) {
  return feature.x_m >= grid.x(0) && feature.x_m <= grid.x(grid.cols - 1) && feature.y_m >= grid.y(0) &&
         feature.y_m <= grid.y(grid.rows - 1);
}

/// A half-open range of node numbers along one axis.
struct NodeRange {
  std::int64_t begin;
  std::int64_t end;
};

/// The nodes within `reach` of `center` (both in node spacings from node 0), plus one more on each side,
/// clipped to the first `count` nodes.
NodeRange nodes_within(double center, double reach, std::int64_t count) {
  const auto clamped = [&](double node) {
    if (!(node > 0)) return std::int64_t{0};
    return node < static_cast<double>(count) ? static_cast<std::int64_t>(node) : count;
  };
  return {clamped(std::floor(center - reach)), clamped(std::ceil(center + reach) + 1)};
}

struct NodeBox {
  NodeRange rows;
  NodeRange cols;
  [[nodiscard]] bool empty() const { return rows.begin >= rows.end || cols.begin >= cols.end; }
};

/// The nodes of a grid that hold a feature's whole footprint.
NodeBox box_of(const Feature& feature, const GridSpec& spec) {
  const double reach_m = std::visit([](const auto& shape) { return shape.reach_m(); }, feature.shape);
  const double reach = reach_m / spec.resolution_m;
  return {
      nodes_within(feature.y_m / spec.resolution_m - static_cast<double>(spec.first_row), reach, spec.rows),
      nodes_within(feature.x_m / spec.resolution_m - static_cast<double>(spec.first_col), reach, spec.cols)};
}

/// The relief of a shape as a function of the offset from its centre. Common terms are computed once.
template <class Shape>
auto relief_of(const Shape& shape) {
  if constexpr (requires { shape.own_relief_m(Offset{}); })
    return [shape, axes = TurnedAxes(shape.yaw_rad)](const Offset& offset) {
      return shape.own_relief_m(axes.own(offset));
    };
  else
    return [shape](const Offset& offset) { return shape.relief_m(offset); };
}

/// Calls change(node, relief) for the nodes of some rows that lie on a feature's footprint.
template <class F>
void stamp(const GridSpec& spec, const Feature& feature, const NodeRange& rows, const F& change) {
  const NodeBox box = box_of(feature, spec);
  const NodeRange own_rows{std::max(box.rows.begin, rows.begin), std::min(box.rows.end, rows.end)};
  std::visit(
      [&](const auto& shape) {
        const auto relief_m = relief_of(shape);
        for (std::int64_t row = own_rows.begin; row < own_rows.end; ++row)
          for (std::int64_t col = box.cols.begin; col < box.cols.end; ++col) {
            const double here_m = relief_m({spec.x(col) - feature.x_m, spec.y(row) - feature.y_m});
            if (!std::isnan(here_m)) change(BinIndex{row, col}, here_m);
          }
      },
      feature.shape);
}

/// For each band of kRowGrain rows of a grid, the features of one role that may reach it, in the order of the
/// features: the elevation of a node depends neither on the bands nor on the threads.
class FeatureBands {
 public:
  FeatureBands(const std::vector<PlacedFeature>& features, FeatureRole role, const GridSpec& spec)
      : features_(features), rows_(spec.rows), first_(band_count() + 1) {
    const auto for_each_entry = [&](const auto& take) {
      for (std::size_t i = 0; i < features.size(); ++i) {
        if (role_of(features[i].feature) != role) continue;
        const NodeBox box = box_of(features[i].feature, spec);
        if (box.empty()) continue;
        const auto last = static_cast<std::size_t>(box.rows.end - 1) / kRowGrain;
        for (auto band = static_cast<std::size_t>(box.rows.begin) / kRowGrain; band <= last; ++band)
          take(band, i);
      }
    };
    for_each_entry([&](std::size_t band, std::size_t) { ++first_[band + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    entries_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for_each_entry([&](std::size_t band, std::size_t i) { entries_[next[band]++] = i; });
  }

  /// Calls work(rows, entries) for every band that has features, on all threads; feature() maps an entry to
  /// its feature.
  template <class F>
  void for_each(const ProgressCallback& progress, const F& work) const {
    parallel_for(
        band_count(), 1,
        [&](std::size_t band, std::size_t) {
          const std::span all(entries_);
          const auto entries = all.subspan(first_[band], first_[band + 1] - first_[band]);
          const auto begin = static_cast<std::int64_t>(band * kRowGrain);
          const auto end = std::min(begin + static_cast<std::int64_t>(kRowGrain), rows_);
          if (!entries.empty()) work(NodeRange{begin, end}, entries);
        },
        progress);
  }
  [[nodiscard]] const PlacedFeature& feature(std::size_t entry) const { return features_[entry]; }

 private:
  [[nodiscard]] std::size_t band_count() const {
    return (static_cast<std::size_t>(rows_) + kRowGrain - 1) / kRowGrain;
  }

  const std::vector<PlacedFeature>& features_;
  std::int64_t rows_;
  std::vector<std::size_t> first_;
  std::vector<std::size_t> entries_;
};

/// Gives nodes the albedo of a kind of features; without a layer it has no effect.
class AlbedoBrush {
 public:
  AlbedoBrush(const AlbedoModel& model, Grid<float>* layer) : model_(model), layer_(layer) {}

  void touch(const BinIndex& node, const Feature& feature) const {
    if (layer_ == nullptr) return;
    if (const std::optional<double>& albedo = model_.of_kind[feature.shape.index()])
      layer_->at(node) = static_cast<float>(*albedo);
  }

 private:
  const AlbedoModel& model_;
  Grid<float>* layer_;
};

/// Adds the highest relief of all draped features to the ground.
void drape(Grid<double>& part, const FeatureBands& bands, const AlbedoBrush& brush,
           const ProgressCallback& progress) {
  const GridSpec& spec = part.spec();
  bands.for_each(progress, [&](const NodeRange& rows, std::span<const std::size_t> entries) {
    std::vector<double> highest_m(static_cast<std::size_t>((rows.end - rows.begin) * spec.cols), kNoRelief);
    const auto offset = [&](const BinIndex& node) {
      return static_cast<std::size_t>((node.row - rows.begin) * spec.cols + node.col);
    };
    for (const std::size_t entry : entries)
      stamp(spec, bands.feature(entry).feature, rows, [&](const BinIndex& node, double relief_m) {
        double& highest = highest_m[offset(node)];
        if (highest >= relief_m) return;
        highest = relief_m;
        brush.touch(node, bands.feature(entry).feature);
      });
    for (std::int64_t row = rows.begin; row < rows.end; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const double relief_m = highest_m[offset({row, col})];
        if (!std::isnan(relief_m)) part.at({row, col}) += relief_m;
      }
  });
}

/// A coordinate in node spacings from the origin, rounded to a node within 1e-9 of it.
double node_place(double position_m, double resolution_m) {
  const double position = position_m / resolution_m;
  const double node = std::round(position);
  return std::abs(position - node) < 1e-9 ? node : position;
}

/// The elevation of the ground at a point, bit-identical for every part that has its cell: the position in
/// the cell is independent of the part's first node. NaN where the part lacks the cell or the cell has a hole
/// there.
double ground_in_cell(const Grid<double>& part, const Feature& feature) {
  const GridSpec& spec = part.spec();
  const double x = node_place(feature.x_m, spec.resolution_m);
  const double y = node_place(feature.y_m, spec.resolution_m);
  const double u = x - std::floor(x);
  const double v = y - std::floor(y);
  const BinIndex cell{static_cast<std::int64_t>(std::floor(y)) - spec.first_row,
                      static_cast<std::int64_t>(std::floor(x)) - spec.first_col};
  const std::int64_t right = cell.col + (u > 0 ? 1 : 0);
  const std::int64_t top = cell.row + (v > 0 ? 1 : 0);
  if (cell.row < 0 || cell.col < 0 || right >= spec.cols || top >= spec.rows) return kNoRelief;
  const double b = part.at({cell.row, right});
  const double c = part.at({top, cell.col});
  if (u + v <= 1) {
    const double a = part.at(cell);
    return a + u * (b - a) + v * (c - a);
  }
  const double d = part.at({top, right});
  return d + (1 - u) * (c - d) + (1 - v) * (b - d);
}

void require_on_grid(const PlacedFeature& placed, const GridSpec& grid) {
  if (role_of(placed.feature) == FeatureRole::stands && !on_grid(grid, placed.feature))
    throw UsageError(centre_of(placed) + "outside the grid");
}

template <class F>
void for_each_listed(const std::vector<Feature>& features, const F& take) {
  for (std::size_t i = 0; i < features.size(); ++i)
    take(PlacedFeature{.feature = features[i], .number = static_cast<std::int64_t>(i)});
}

/// The features of a pattern, in its order.
template <class Pattern, class F>
void for_each_of(const Pattern& pattern, std::size_t index, const PatternSite& site, const F& take) {
  std::int64_t number = 0;
  for (const Feature& feature : pattern.features(site))
    take(PlacedFeature{.feature = feature,
                       .pattern = static_cast<std::int32_t>(index),
                       .number = number++,
                       .is_random = pattern.kIsRandom});
}

}  // namespace

void require_on_grid(const TerrainModel& model, const GridSpec& grid) {
  for_each_listed(model.features, [&](const PlacedFeature& placed) { require_on_grid(placed, grid); });
  for (std::size_t p = 0; p < model.patterns.size(); ++p)
    std::visit(
        [&](const auto& pattern) {
          if (!pattern.kIsRandom)
            for_each_of(pattern, p, pattern_site(grid, model.seed, p),
                        [&](const PlacedFeature& placed) { require_on_grid(placed, grid); });
        },
        model.patterns[p]);
}

FeatureField::FeatureField(const TerrainModel& model, const GridSpec& grid)
    : grid_(grid), albedo_(model.albedo.value_or(AlbedoModel{})) {
  const auto add = [&](const PlacedFeature& placed) {
    require_on_grid(placed, grid);
    features_.push_back(placed);
  };
  for_each_listed(model.features, add);
  for (std::size_t p = 0; p < model.patterns.size(); ++p)
    std::visit([&](const auto& pattern) { for_each_of(pattern, p, pattern_site(grid, model.seed, p), add); },
               model.patterns[p]);
}

void FeatureField::shape_ground(Grid<double>& part, const ProgressCallback& progress,
                                Grid<float>* albedo) const {
  const AlbedoBrush brush(albedo_, albedo);
  const FeatureBands adding(features_, FeatureRole::adds, part.spec());
  adding.for_each([&](double fraction) { report(progress, fraction / 2); },
                  [&](const NodeRange& rows, std::span<const std::size_t> entries) {
                    for (const std::size_t entry : entries) {
                      const Feature& feature = adding.feature(entry).feature;
                      stamp(part.spec(), feature, rows, [&](const BinIndex& node, double relief_m) {
                        part.at(node) += relief_m;
                        brush.touch(node, feature);
                      });
                    }
                  });
  drape(part, FeatureBands(features_, FeatureRole::drapes, part.spec()), brush,
        [&](double fraction) { report(progress, 0.5 + fraction / 2); });
}

void FeatureField::seat(const TriangulatedGrid& part) {
  const GridSpec& spec = part.nodes().spec();
  const bool holds_last_row = spec.first_row + spec.rows == grid_.first_row + grid_.rows;
  for (PlacedFeature& placed : features_) {
    if (placed.ground_m || !on_grid(spec, placed.feature)) continue;
    if (!holds_last_row && placed.feature.y_m == spec.y(spec.rows - 1)) continue;
    double z_m = ground_in_cell(part.nodes(), placed.feature);
    if (!std::isfinite(z_m)) z_m = part.elevation(placed.feature.x_m, placed.feature.y_m);
    if (std::isfinite(z_m))
      placed.ground_m = z_m;
    else if (role_of(placed.feature) == FeatureRole::stands && placed.is_random)
      placed.ground_m = std::numeric_limits<double>::quiet_NaN();
    else if (role_of(placed.feature) == FeatureRole::stands)
      throw FormatError(centre_of(placed) + "on a hole of the base");
  }
}

bool FeatureField::can_stand(std::int64_t begin, std::int64_t end) const {
  return std::ranges::all_of(features_, [&](const PlacedFeature& placed) {
    if (placed.ground_m || role_of(placed.feature) != FeatureRole::stands) return true;
    const NodeRange rows = box_of(placed.feature, grid_).rows;
    return std::max(rows.begin, begin) >= std::min(rows.end, end);
  });
}

void FeatureField::stand(Grid<double>& part, const ProgressCallback& progress, Grid<float>* albedo) const {
  const AlbedoBrush brush(albedo_, albedo);
  const FeatureBands standing(features_, FeatureRole::stands, part.spec());
  standing.for_each(progress, [&](const NodeRange& rows, std::span<const std::size_t> entries) {
    for (const std::size_t entry : entries) {
      const PlacedFeature& placed = standing.feature(entry);
      stamp(part.spec(), placed.feature, rows, [&](const BinIndex& node, double relief_m) {
        if (!placed.ground_m) throw std::logic_error("a standing feature was not seated");
        double& z = part.at(node);
        const double top_m = *placed.ground_m + relief_m;
        if (!(z < top_m)) return;
        z = top_m;
        brush.touch(node, placed.feature);
      });
    }
  });
}

}  // namespace landfall
