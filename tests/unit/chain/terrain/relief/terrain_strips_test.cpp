// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/terrain_strips.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/core/error.h"
#include "bins.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "refusal.h"
#include "relief/no_raster.h"

namespace landfall {
namespace {

constexpr GridSpec kStripsGrid{0.5, -203, -150, 407, 301};

/// A 401 x 401 raster of 1 m pixels around the site centre, with a hole.
DemRaster bumpy_raster(const DemBase& dem, const GridSpec&) {
  DemSamples samples{{401, 401}, {}};
  for (int row = 0; row < 401; ++row)
    for (int col = 0; col < 401; ++col) samples.values.push_back(3 * std::sin(0.1 * row) + 0.2 * (col % 7));
  samples.values[150 * 401 + 200] = std::numeric_limits<double>::quiet_NaN();
  const SiteMapping mapping(GeoTransform({0, 1, 0, 0, 0, -1}), {200, 200}, 1);
  return {samples, mapping, "a crs", {dem.path, "MEM", samples.size, dem.band}};
}

/// Features everywhere, also on nodes of the rows where strips of 64 rows meet, some as high as several
/// strips.
TerrainModel model() {
  TerrainModel model;
  DemBase dem;
  dem.path = "bumpy";
  model.bases = {PlaneBase{1, 0.1, -0.2}, FractalBase{0.7, 0.3, 5}, dem};
  for (int i = 0; i < 40; ++i) {
    const double y_m = kStripsGrid.y(10 * i);
    model.features.push_back({-60 + 3.1 * i, y_m + (i % 2 == 0 ? 0 : 0.137), Cone{3, 5}});
  }
  for (const std::int64_t row : {0, 63, 64, 65, 127, 128, 192, 406})
    model.features.push_back({20.123, kStripsGrid.y(row), Hemisphere{row == 192 ? 80.0 : 4.0}});
  return model;
}

struct Made {
  Grid<double> nodes;
  std::vector<PlacedFeature> features;
  std::vector<std::int64_t> heights;
};

Made made(std::int64_t max_nodes, std::int64_t rows) {
  TerrainStrips strips(model(), kStripsGrid, bumpy_raster, {max_nodes, rows});
  Made result{Grid<double>(kStripsGrid), {}, {}};
  std::int64_t next = 0;
  strips.make([&](const TerrainStrip& part) {
    const Grid<double>& strip = part.nodes;
    EXPECT_EQ(strip.spec().first_row, kStripsGrid.first_row + next);
    EXPECT_EQ(strip.spec().cols, kStripsGrid.cols);
    std::ranges::copy(strip.values(), result.nodes.row(next).begin());
    next += strip.spec().rows;
    result.heights.push_back(strip.spec().rows);
  });
  EXPECT_EQ(next, kStripsGrid.rows);
  result.features = strips.features();
  return result;
}

bool same_or_hole(const Grid<double>& a, const Grid<double>& b) {
  return std::ranges::equal(a.values(), b.values(),
                            [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

TEST(TerrainStrips, TheirHeightChangesNothing) {
  const Made whole = made(1000, kStripsGrid.rows);
  EXPECT_EQ(whole.heights, std::vector<std::int64_t>{407});
  EXPECT_EQ(std::ranges::count_if(whole.nodes.values(), [](double z) { return std::isnan(z); }) > 0, true);
  for (const std::int64_t rows : {4, 63, 64, 101, 256, 404}) {
    const Made parts = made(1000, rows);
    EXPECT_TRUE(same_or_hole(parts.nodes, whole.nodes)) << rows;
    EXPECT_EQ(parts.features, whole.features) << rows;
  }
  EXPECT_EQ(made(1000, 101).heights, (std::vector<std::int64_t>{101, 101, 101, 104}));
}

// Small terrains are one piece, with the one fractal that fits them best.
TEST(TerrainStrips, OnePieceIsGenerateTerrain) {
  const Made one = made(kStripsGrid.rows * kStripsGrid.cols, 64);
  EXPECT_EQ(one.heights, std::vector<std::int64_t>{407});
  EXPECT_TRUE(same_or_hole(one.nodes, generate_terrain(model(), kStripsGrid, bumpy_raster).nodes));
  EXPECT_FALSE(same_or_hole(one.nodes, made(1000, kStripsGrid.rows).nodes));
}

// The rim of the crater-wide dome reaches far north of its own strip, and south of it: those strips wait.
TEST(TerrainStrips, FeaturesStandOnTheGroundUnderTheirCentre) {
  TerrainModel slope;
  slope.bases = {PlaneBase{0, 0, 0.5}};
  slope.features = {{0, 31.25, Hemisphere{60}}};
  TerrainStrips strips(slope, kStripsGrid, no_raster, {1000, 16});
  strips.make([&](const TerrainStrip& part) {
    const Grid<double>& strip = part.nodes;
    const GridSpec& spec = strip.spec();
    for (const auto [r, c] : bins_of(spec)) {
      const double square = 3600 - std::pow(spec.x(c), 2) - std::pow(spec.y(r) - 31.25, 2);
      const double ground_m = 0.5 * spec.y(r);
      const double expected_m = square >= 0 ? std::max(ground_m, 15.625 + std::sqrt(square)) : ground_m;
      ASSERT_NEAR(strip.at({r, c}), expected_m, 1e-9);
    }
  });
}

TEST(TerrainStrips, ADemWithoutRelief) {
  const DemLoader empty = [](const DemBase& dem, const GridSpec& site) {
    DemRaster raster = bumpy_raster(dem, site);
    std::ranges::fill(raster.samples.values, std::numeric_limits<double>::quiet_NaN());
    return raster;
  };
  TerrainModel holes;
  DemBase dem;
  dem.path = "empty";
  dem.datum = Datum::none;
  holes.bases = {dem};
  TerrainStrips strips(holes, kStripsGrid, empty, {1000, 64});
  EXPECT_THROW(strips.make([](const TerrainStrip&) {}), FormatError);
}

// At a pole, columns of longitude meet in one point: no wavelength can be told that the raster lacks.
TEST(TerrainStrips, AFractalOnTheDemOfAPole) {
  const DemLoader pole = [](const DemBase& dem, const GridSpec& site) {
    DemRaster raster = bumpy_raster(dem, site);
    raster.mapping =
        SiteMapping(GeoTransform({-180, 1, 0, 90.5, 0, -1}), {180, 0},
                    OrthographicFrame({1e6, 0}, {0, std::numbers::pi / 2}), std::numbers::pi / 180);
    return raster;
  };
  TerrainModel model;
  DemBase dem;
  dem.path = "pole";
  dem.datum = Datum::none;
  model.bases = {dem, FractalBase{0.7, 0.3, 5}};
  EXPECT_THAT(refusal<FormatError>([&] {
                const TerrainStrips strips(model, kStripsGrid, pole, {1000, 64});
              }),
              ::testing::AllOf(::testing::StartsWith("pole: has no posting at the site centre"),
                               ::testing::HasSubstr("longest_wavelength_m")));
  std::get<FractalBase>(model.bases[1]).longest_wavelength_m = 4;
  EXPECT_NO_THROW(TerrainStrips(model, kStripsGrid, pole, {1000, 64}));
}

TEST(TerrainStrips, ProgressRisesToOne) {
  std::vector<double> fractions;
  TerrainStrips strips(model(), kStripsGrid, bumpy_raster, {1000, 64});
  strips.make([](const TerrainStrip&) {}, [&](double fraction) { fractions.push_back(fraction); });
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace landfall
