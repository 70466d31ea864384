// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/feature_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "bins.h"
#include "constants.h"

namespace landfall {
namespace {

/// Elevations of a plane that rises `slope` to the east.
Grid<double> sloping(const GridSpec& spec, double slope) {
  return grid_of(spec, [&](double x, double) { return slope * x; });
}

TEST(FeatureField, AStandingFeatureShowsWhereItIsHigher) {
  TerrainModel model;
  model.features = {{2, 0, Cone{3, 10}}};
  const GridSpec spec = GridSpec::centered(8, 0.5);
  FeatureField field(model, spec);
  Grid<double> z = sloping(spec, 2);
  field.seat(TriangulatedGrid(z));
  EXPECT_EQ(field.features()[0].ground_m, 4);
  field.stand(z);
  EXPECT_EQ(z.at({16, 20}), 14);  // the top, at x = 2
  EXPECT_EQ(z.at({16, 17}), 9);   // x = 0.5: 4 + 5 over ground at 1
  EXPECT_EQ(z.at({16, 24}), 8);   // x = 4: the ground, 8, over 4 + 10 / 3
}

TEST(FeatureField, AHoleStaysAHole) {
  TerrainModel model;
  model.features = {{0, 0, Cone{3, 10}}, {0, 0, Hemisphere{2}}, {0, 0, Pyramid{}}};
  const GridSpec spec = GridSpec::centered(8, 0.5);
  FeatureField field(model, spec);
  Grid<double> z = sloping(spec, 0);
  field.seat(TriangulatedGrid(z));
  z.at({17, 16}) = kNan;
  field.stand(z);
  EXPECT_TRUE(std::isnan(z.at({17, 16})));
}

TEST(FeatureField, WhatStandsOnAHoleByChanceDoesNotAppear) {
  TerrainModel model;
  RockPattern rocks;
  rocks.population.law = GolombekLaw{0.2};
  rocks.population.diameters = {0.5, 2};
  model.patterns = {rocks};
  const GridSpec spec = GridSpec::centered(40, 0.5);
  FeatureField field(model, spec);
  Grid<double> z = sloping(spec, 0);
  for (const BinIndex bin : Bins({0, 0}, {spec.rows, 80})) z.at(bin) = kNan;  // the western half
  field.seat(TriangulatedGrid(z));
  field.stand(z);
  std::size_t on_holes = 0;
  for (const PlacedFeature& placed : field.features()) on_holes += std::isnan(*placed.ground_m) ? 1U : 0U;
  EXPECT_GT(on_holes, 20U);
  EXPECT_LT(on_holes, field.features().size() - 20);
  EXPECT_TRUE(std::isnan(z.at({80, 40})));
  double highest_m = 0;
  for (const double elevation : z.values()) highest_m = std::fmax(highest_m, elevation);
  EXPECT_GT(highest_m, 0.1);
}

TEST(FeatureField, RefusesAStandingFeatureWithoutGround) {
  TerrainModel model;
  model.features = {{0, 0, Cone{3, 10}}, {9, 0, Cone{3, 10}}};
  const GridSpec spec = GridSpec::centered(8, 0.5);
  EXPECT_THROW(FeatureField(model, spec), UsageError);
  model.features.pop_back();
  FeatureField field(model, spec);
  Grid<double> z = sloping(spec, 0);
  EXPECT_THROW(field.stand(z), std::logic_error);
  z.at({16, 16}) = kNan;
  EXPECT_THROW(field.seat(TriangulatedGrid(z)), FormatError);
}

// Two craters add, in the order of the list; of two draped ridges the higher counts, on the ground that the
// craters leave; the rock stands on all of that.
TEST(FeatureField, RolesInTheirOrder) {
  TerrainModel model;
  const Crater crater{8, 1, 0.7};
  const Ridge low{100, 2, 1, 0, 0, 0};
  const Ridge high{100, 1, 2, 0, 0, 0.2};
  const Rock rock{1, 0.5, 0.8, 0};
  model.features = {{0, 1, rock}, {0, 0, low},     {1, 0, crater},
                    {0, 0, high}, {30, 0, crater}, {-1, 0, crater}};
  const GridSpec spec = GridSpec::centered(8, 0.5);
  FeatureField field(model, spec);
  const Grid<double> base = sloping(spec, 0.3);
  Grid<double> z = base;
  field.shape_ground(z);
  const auto sum_at = [&](const BinIndex& node) {
    const double x_m = spec.x(node.col);
    const double y_m = spec.y(node.row);
    double sum = base.at(node);
    for (const double center_m : {1.0, -1.0}) {
      const double relief_m = crater.relief_m({x_m - center_m, y_m});
      if (!std::isnan(relief_m)) sum += relief_m;
    }
    return sum + std::fmax(low.relief_m({x_m, y_m}), high.relief_m({x_m, y_m}));
  };
  for (const BinIndex node : {BinIndex{16, 16}, BinIndex{17, 12}, BinIndex{12, 20}, BinIndex{20, 31}})
    EXPECT_EQ(z.at(node), sum_at(node)) << node.row << " " << node.col;
  field.seat(TriangulatedGrid(z));
  const double seat_m = z.at({18, 16});
  EXPECT_EQ(field.features()[0].ground_m, seat_m);
  EXPECT_EQ(field.features()[2].ground_m, z.at({16, 18}));
  EXPECT_FALSE(field.features()[4].ground_m);  // a crater off the grid
  field.stand(z);
  EXPECT_EQ(z.at({18, 16}), seat_m + 0.5);
}

TEST(FeatureField, WhatReachesInFromOutsideCounts) {
  TerrainModel model;
  model.features = {{-11, 0, Crater{8, 1, 1}}, {0, 500, Ridge{1000, 2, 3, 0, 0, std::acos(0.0)}}};
  const GridSpec spec = GridSpec::centered(8, 0.5);
  const FeatureField field(model, spec);
  Grid<double> z = sloping(spec, 0);
  field.shape_ground(z);
  EXPECT_NEAR(z.at({16, 0}), (Crater{8, 1, 1}.relief_m({3, 0})), 1e-15);
  EXPECT_NEAR(z.at({20, 16}), 3, 1e-12);
  EXPECT_EQ(z.at({20, 31}), 0);
}

TEST(FeatureField, TheHighestOfSeveralDrapesIsNotTheirSum) {
  TerrainModel model;
  model.features = {{0, 0, Ridge{100, 2, 1, 0, 0, 0}}, {0, 0, Ridge{100, 2, 1, 0, 0, 0}}};
  const GridSpec spec = GridSpec::centered(8, 0.5);
  const FeatureField field(model, spec);
  Grid<double> z = sloping(spec, 0);
  field.shape_ground(z);
  EXPECT_EQ(z.at({16, 3}), 1);
}

/// Features of every role and shape, some that meet, some that reach in from outside.
TerrainModel crowded_model() {
  TerrainModel model;
  PenitenteField blades{6, 4, 0, 0.4, 1.3, 0.7, 0.5, 0.3, 0.2, 2, 9};
  model.features = {{0, 0, Rock{3, 1, 0.6, 0.4}},
                    {1, 1, Crater{9, 0, 0.8}},
                    {-2, -1, Crater{7, 0, 0.3}},
                    {-12, 3, Crater{12, 0, 1}},
                    {2, -3, IceBlock{2, 1, 1, 0.3, 0.2}},
                    {0, 20, Ridge{60, 3, 1, 2, 5, 1.3}},
                    {0, 0, Ridge{9, 2, 1.5, 0, 1, 0.5}},
                    {1, 2, Fracture{14, 1, 2, 0.5, 3, 1.1, 2, -0.4}},
                    {-4, 4, Pit{2, 1, 1.2}},
                    {3, 3, blades},
                    {3, -6, Hemisphere{1.5}},
                    {-6, -6, Pyramid{2, 2, 0.2}}};
  model.patterns = {RingPattern{7, 4, 0.3, Cone{2, 3}}, RingPattern{50, 6, 0.1, Crater{3, 0, 0.37}}};
  return model;
}

TEST(FeatureField, PartsMakeTheSameTerrainAsTheWhole) {
  const TerrainModel model = crowded_model();
  const GridSpec spec = GridSpec::centered(8, 0.1);
  const auto make = [&](const std::vector<GridSpec>& parts) {
    FeatureField field(model, spec);
    std::vector<Grid<double>> grids;
    for (const GridSpec& part : parts) grids.push_back(sloping(part, 0.25));
    for (Grid<double>& grid : grids) field.shape_ground(grid);
    for (const Grid<double>& grid : grids) field.seat(TriangulatedGrid(grid));
    for (Grid<double>& grid : grids) field.stand(grid);
    return grids;
  };
  const Grid<double> whole = make({spec})[0];
  EXPECT_NE(whole.at({80, 80}), 0);
  const auto part_of = [&](std::int64_t row, std::int64_t rows, std::int64_t col, std::int64_t cols) {
    GridSpec part = spec;
    part.first_row += row;
    part.rows = rows;
    part.first_col += col;
    part.cols = cols;
    return part;
  };
  // They share a row and a column: every cell lies in one of them.
  const std::vector<GridSpec> quarters = {part_of(0, 75, 0, 98), part_of(0, 75, 97, 64),
                                          part_of(74, 87, 0, 98), part_of(74, 87, 97, 64)};
  for (const Grid<double>& part : make(quarters))
    for (const auto [row, col] : bins_of(part.spec()))
      ASSERT_EQ(part.at({row, col}), whole.at({row + part.spec().first_row - spec.first_row,
                                               col + part.spec().first_col - spec.first_col}));
}

TEST(FeatureField, ThreadsChangeNothing) {
  const TerrainModel model = crowded_model();
  const GridSpec spec = GridSpec::centered(8, 0.1);
  const auto make = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    FeatureField field(model, spec);
    Grid<double> z = sloping(spec, 0.25);
    field.shape_ground(z);
    field.seat(TriangulatedGrid(z));
    field.stand(z);
    return z;
  };
  const Grid<double> one = make(1);
  const Grid<double> two = make(2);
  EXPECT_TRUE(std::equal(one.values().begin(), one.values().end(), two.values().begin()));
}

}  // namespace
}  // namespace landfall
