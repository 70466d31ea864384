// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/feature_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/error.h"

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Elevations of a plane that rises `slope` to the east.
Grid<double> sloping(const GridSpec& spec, double slope) {
  Grid<double> z(spec);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) z.at({row, col}) = slope * spec.x(col);
  return z;
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

TEST(FeatureField, PartsMakeTheSameTerrainAsTheWhole) {
  TerrainModel model;
  model.patterns = {RingPattern{7, 4, 0.3, Cone{2, 3}}};
  const GridSpec spec = GridSpec::centered(8, 0.5);
  const auto make = [&](const std::vector<GridSpec>& parts) {
    FeatureField field(model, spec);
    std::vector<Grid<double>> grids;
    for (const GridSpec& part : parts) grids.push_back(sloping(part, 0.25));
    for (const Grid<double>& grid : grids) field.seat(TriangulatedGrid(grid));
    for (Grid<double>& grid : grids) field.stand(grid);
    return grids;
  };
  const Grid<double> whole = make({spec})[0];
  GridSpec south = spec;
  south.rows = 15;
  GridSpec north = spec;
  north.first_row += 14;  // the last row of the other part: cells lie in one of both
  north.rows -= 14;
  for (const Grid<double>& part : make({south, north}))
    for (std::int64_t row = 0; row < part.spec().rows; ++row)
      for (std::int64_t col = 0; col < part.spec().cols; ++col)
        EXPECT_EQ(part.at({row, col}), whole.at({row + part.spec().first_row - spec.first_row, col}));
}

}  // namespace
}  // namespace landfall
