// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/feature_field.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "base/error.h"
#include "base/parallel.h"

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

/// The nodes within `reach` of `center` (both in node spacings from node 0), one more on each side, cut to
/// `limits`.
NodeRange nodes_within(double center, double reach, const NodeRange& limits) {
  const auto clamped = [&](double node) {
    return static_cast<std::int64_t>(
        std::clamp(node, static_cast<double>(limits.begin), static_cast<double>(limits.end)));
  };
  return {clamped(std::floor(center - reach)), clamped(std::ceil(center + reach) + 1)};
}

/// Calls change(node, relief) for the nodes of some rows that lie on a feature's footprint.
template <class F>
void stamp(Grid<double>& z, const Feature& feature, const NodeRange& rows, const F& change) {
  const GridSpec& spec = z.spec();
  std::visit(
      [&](const auto& shape) {
        const double reach = shape.reach_m() / spec.resolution_m;
        const NodeRange r =
            nodes_within(feature.y_m / spec.resolution_m - static_cast<double>(spec.first_row), reach, rows);
        const NodeRange c = nodes_within(
            feature.x_m / spec.resolution_m - static_cast<double>(spec.first_col), reach, {0, spec.cols});
        for (std::int64_t row = r.begin; row < r.end; ++row)
          for (std::int64_t col = c.begin; col < c.end; ++col) {
            const double relief_m = shape.relief_m({spec.x(col) - feature.x_m, spec.y(row) - feature.y_m});
            if (!std::isnan(relief_m)) change(z.at({row, col}), relief_m);
          }
      },
      feature.shape);
}

/// Calls work(rows) for pieces of the grid's rows, on all threads.
template <class F>
void for_row_ranges(const GridSpec& spec, const ProgressCallback& progress, const F& work) {
  parallel_for(
      static_cast<std::size_t>(spec.rows), kRowGrain,
      [&](std::size_t begin, std::size_t end) {
        work(NodeRange{static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end)});
      },
      progress);
}

}  // namespace

FeatureField::FeatureField(const TerrainModel& model, const GridSpec& grid) {
  const auto place = [&](const Feature& feature, std::int32_t pattern, std::size_t number) {
    features_.push_back({feature, pattern, static_cast<std::int64_t>(number), std::nullopt});
    if (role_of(feature) == FeatureRole::stands && !on_grid(grid, feature))
      throw UsageError(centre_of(features_.back()) + "outside the grid");
  };
  for (std::size_t i = 0; i < model.features.size(); ++i) place(model.features[i], -1, i);
  for (std::size_t p = 0; p < model.patterns.size(); ++p) {
    const PatternSite site{grid.x(0),  grid.x(grid.cols - 1),        grid.y(0), grid.y(grid.rows - 1),
                           model.seed, static_cast<std::uint64_t>(p)};
    const auto features =
        std::visit([&](const auto& pattern) { return pattern.features(site); }, model.patterns[p]);
    for (std::size_t i = 0; i < features.size(); ++i) place(features[i], static_cast<std::int32_t>(p), i);
  }
}

void FeatureField::shape_ground(Grid<double>& part, const ProgressCallback& progress) const {
  for_row_ranges(part.spec(), progress, [&](const NodeRange& rows) {
    for (const PlacedFeature& placed : features_)
      if (role_of(placed.feature) == FeatureRole::adds)
        stamp(part, placed.feature, rows, [](double& z, double relief_m) { z += relief_m; });
  });
}

void FeatureField::seat(const TriangulatedGrid& part) {
  for (PlacedFeature& placed : features_) {
    if (placed.ground_m || !on_grid(part.nodes().spec(), placed.feature)) continue;
    const double z_m = part.elevation(placed.feature.x_m, placed.feature.y_m);
    if (std::isfinite(z_m))
      placed.ground_m = z_m;
    else if (role_of(placed.feature) == FeatureRole::stands)
      throw FormatError(centre_of(placed) + "on a hole of the base");
  }
}

void FeatureField::stand(Grid<double>& part, const ProgressCallback& progress) const {
  for_row_ranges(part.spec(), progress, [&](const NodeRange& rows) {
    for (const PlacedFeature& placed : features_) {
      if (role_of(placed.feature) != FeatureRole::stands) continue;
      if (!placed.ground_m) throw std::logic_error("a standing feature was not seated");
      stamp(part, placed.feature, rows, [&](double& z, double relief_m) {
        const double top_m = *placed.ground_m + relief_m;
        if (z < top_m) z = top_m;
      });
    }
  });
}

}  // namespace landfall
