// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/terrain_generator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "bins.h"
#include "chain/terrain/relief/fractal.h"
#include "constants.h"
#include "refusal.h"
#include "relief/no_raster.h"

namespace landfall {
namespace {

Grid<double> nodes_of(const TerrainModel& model, const GridSpec& spec, const DemLoader& load = no_raster) {
  return generate_terrain(model, spec, load).nodes;
}

/// A 21 x 21 raster of 1 m pixels around the site centre, z = 100 + 2 column + row from its upper left.
DemRaster slope_raster(const DemBase& dem, const GridSpec&) {
  DemSamples samples{{21, 21}, {}};
  for (int row = 0; row < 21; ++row)
    for (int col = 0; col < 21; ++col) samples.values.push_back(100 + 2 * col + row);
  const SiteMapping mapping(GeoTransform({0, 1, 0, 0, 0, -1}), {10, 10}, 1);
  return {samples, mapping, "a crs", {dem.path, "MEM", samples.size, dem.band}};
}

DemBase dem_base() {
  DemBase dem;
  dem.path = "slope";
  return dem;
}

TEST(GenerateTerrain, ConeOnAPlaneIsExact) {
  TerrainModel model;
  model.features = {{1, -2, Cone{3, 10}}};
  const Grid<double> z = nodes_of(model, GridSpec::centered(6, 0.25));
  for (const auto [r, c] : bins_of(z.spec())) {
    const double distance_m = std::hypot(z.spec().x(c) - 1, z.spec().y(r) + 2);
    EXPECT_EQ(z.at({r, c}), distance_m <= 3 ? 10 * (1 - distance_m / 3) : 0);
  }
}

TEST(GenerateTerrain, BasesAreSummed) {
  TerrainModel model;
  model.bases = {PlaneBase{1, 0.5, 0}, PlaneBase{2, 0, -0.25}};
  const Grid<double> z = nodes_of(model, GridSpec::centered(4, 1));
  EXPECT_EQ(z.at({8, 0}), 3 - 2 - 1);  // x = -4, y = 4
  EXPECT_EQ(z.at({4, 4}), 3);
}

// A cone of 2 m on a plane that rises 0.5 to the east: it stands on the plane's height at its own centre, its
// western flank wins over the ground, far up the slope the ground wins over its eastern flank.
TEST(GenerateTerrain, FeatureStandsOnTheTiltedBaseAtItsCentre) {
  TerrainModel model;
  model.bases = {PlaneBase{0, 0.5, 0}};
  model.features = {{2, 0, Cone{4, 1}}};
  const Grid<double> z = nodes_of(model, GridSpec::centered(8, 1));
  const auto at = [&](std::int64_t x, std::int64_t y) { return z.at({y + 8, x + 8}); };
  EXPECT_EQ(at(2, 0), 2);      // 1 + 1
  EXPECT_EQ(at(0, 0), 1.5);    // 1 + 0.5 over ground 0
  EXPECT_EQ(at(-2, 0), 1);     // 1 + 0 over ground -1: the foot ends in a step
  EXPECT_EQ(at(-3, 0), -1.5);  // outside
  EXPECT_EQ(at(4, 0), 2);      // ground 2 over 1.5
}

TEST(GenerateTerrain, OverlappingFeaturesTakeTheHigher) {
  TerrainModel model;
  model.features = {{0, 0, Cone{4, 4}}, {2, 0, Hemisphere{3}}};
  const Grid<double> z = nodes_of(model, GridSpec::centered(8, 1));
  EXPECT_EQ(z.at({8, 8}), 4);
  EXPECT_EQ(z.at({8, 10}), 3);
  EXPECT_EQ(z.at({8, 9}), 3);  // cone 3, hemisphere sqrt(8)
  std::ranges::reverse(model.features);
  EXPECT_TRUE(std::ranges::equal(z.values(), nodes_of(model, z.spec()).values()));
}

TEST(GenerateTerrain, RingOfThePaper) {
  TerrainModel model;
  model.patterns = {RingPattern{10, 25, 0, Cone{3, 10}}};
  const GridSpec spec = GridSpec::centered(30, 0.25);
  const Grid<double> z = nodes_of(model, spec);
  EXPECT_NEAR(z.at(spec.bin_of(25, 0)), 10, 1e-12);
  EXPECT_NEAR(z.at(spec.bin_of(-25, 0)), 10, 1e-12);
  EXPECT_EQ(z.at(spec.bin_of(0, 25)), 0);  // 90 deg is no multiple of 36 deg
  EXPECT_EQ(z.at(spec.bin_of(0, 0)), 0);
}

std::string generator_refusal(const TerrainModel& model, const DemLoader& load = no_raster) {
  return kind_and_refusal([&] { return generate_terrain(model, GridSpec::centered(4, 1), load); });
}

TEST(GenerateTerrain, CentresMustLieOnTheGrid) {
  TerrainModel model;
  model.features = {{4, 4, Cone{}}, {4.5, 0, Cone{}}};
  EXPECT_EQ(generator_refusal(model), "usage: features/1: its centre (4.5, 0) m is outside the grid");
  model.features.clear();
  model.patterns = {RingPattern{2, 5, 0, Cone{}}};
  EXPECT_THAT(generator_refusal(model), ::testing::HasSubstr("patterns/0 feature 0: its centre (5, 0)"));
}

TEST(GenerateTerrain, ParametersAreChecked) {
  TerrainModel model;
  model.features = {{0, 0, Cone{-1, 1}}};
  EXPECT_THAT(generator_refusal(model), ::testing::StartsWith("usage: features/0/radius_m"));
  EXPECT_THROW((void)generate_terrain({}, GridSpec::centered(16384, 1), no_raster), UsageError);
}

TEST(GenerateTerrain, AbsurdElevationsAreRefused) {
  TerrainModel model;
  model.bases = {PlaneBase{0, 0, 1e300}};
  EXPECT_EQ(
      generator_refusal(model),
      "usage: the elevation at (-4, -4) m is -4e+300 m, farther than 1e12 m from 0; lower what the base "
      "or the features add there");
  model.bases = {PlaneBase{1e308, 1e308, 0}};
  EXPECT_THAT(generator_refusal(model), ::testing::HasSubstr("(-4, -4) m is -inf m"));
  model.bases = {PlaneBase{}};
  model.features = {{1, 2, Cone{1.5, 1e13}}};
  EXPECT_THAT(generator_refusal(model), ::testing::HasSubstr("the elevation at (1, 1) m is 3.33333e+12 m"));
  model.features = {{1, 2, Cone{1.5, 9e11}}};
  EXPECT_EQ(generator_refusal(model), "accepted");
}

TEST(GenerateTerrain, AFractalNeedsAWaveThatTheGridHolds) {
  TerrainModel model;
  model.bases = {PlaneBase{}, FractalBase{.longest_wavelength_m = 2}};
  EXPECT_EQ(
      generator_refusal(model),
      "usage: base/1/longest_wavelength_m: 2 is not above twice the grid's resolution, the shortest wave "
      "that the grid can represent");
  model.bases = {FractalBase{.longest_wavelength_m = 2.5}};
  EXPECT_EQ(generator_refusal(model), "accepted");
}

TEST(GenerateTerrain, DemAroundItsCentre) {
  DemBase dem = dem_base();
  TerrainModel model;
  model.bases = {dem};
  const GeneratedTerrain terrain = generate_terrain(model, GridSpec::centered(4, 0.5), slope_raster);
  EXPECT_EQ(terrain.crs_wkt, "a crs");
  ASSERT_EQ(terrain.dem_sources.size(), 1U);
  EXPECT_EQ(terrain.dem_sources[0], (DemSource{"slope", "MEM", {21, 21}, 1}));
  const Grid<double>& z = terrain.nodes;
  EXPECT_EQ(z.at({8, 8}), 0);                     // datum: the centre
  EXPECT_NEAR(z.at({16, 16}), 2 * 4 - 4, 1e-12);  // x = y = 4: four columns on, four rows up

  dem.datum = Datum::none;
  dem.vertical_scale = 0.5;
  model.bases = {dem, PlaneBase{1, 0, 0}};
  EXPECT_NEAR(nodes_of(model, z.spec(), slope_raster).at({8, 8}), 0.5 * 130 + 1, 1e-12);
}

TEST(GenerateTerrain, WithoutADemTheFrameIsLocal) {
  EXPECT_EQ(generate_terrain({}, GridSpec::centered(1, 1), no_raster).crs_wkt, kLocalSiteCrsWkt);
}

DemLoader with_hole(int row, int col) {
  return [=](const DemBase& dem, const GridSpec& site) {
    DemRaster raster = slope_raster(dem, site);
    raster.samples.values[static_cast<std::size_t>(21 * row + col)] = kNan;
    return raster;
  };
}

TEST(GenerateTerrain, HolesStayHoles) {
  TerrainModel model;
  model.bases = {dem_base()};
  model.features = {{0, 0, Hemisphere{3}}};
  const Grid<double> z = nodes_of(model, GridSpec::centered(4, 1), with_hole(9, 11));  // x = 1, y = 1
  EXPECT_TRUE(std::isnan(z.at({5, 5})));
  EXPECT_EQ(std::ranges::count_if(z.values(), [](double v) { return std::isnan(v); }), 1);
}

TEST(GenerateTerrain, RefusesADemThatCannotServe) {
  TerrainModel model;
  model.bases = {dem_base()};
  EXPECT_EQ(generator_refusal(model, with_hole(10, 10)),
            "format: slope: has no elevation at the site centre, which datum \"center\" needs; give another "
            "center, or datum \"none\"");
  model.features = {{1, 1, Cone{1, 1}}};
  EXPECT_EQ(generator_refusal(model, with_hole(9, 11)),
            "format: features/0: its centre (1, 1) m is on a hole of the base");
  model.features.clear();
  DemBase dem = dem_base();
  dem.datum = Datum::none;
  model.bases = {dem};
  const DemLoader empty = [](const DemBase& base, const GridSpec& site) {
    DemRaster raster = slope_raster(base, site);
    std::ranges::fill(raster.samples.values, kNan);
    return raster;
  };
  EXPECT_EQ(generator_refusal(model, empty),
            "format: slope: no node of the site has an elevation; give another center");
  const DemLoader tiny = [](const DemBase& base, const GridSpec& site) {
    DemRaster raster = slope_raster(base, site);
    raster.samples = {{15, 15}, std::vector<double>(225)};
    return raster;
  };
  EXPECT_EQ(generator_refusal(model, tiny), "accepted");  // 15 x 15 from column 0: the site ends on column 14
  const DemLoader tinier = [](const DemBase& base, const GridSpec& site) {
    DemRaster raster = slope_raster(base, site);
    raster.samples = {{15, 14}, std::vector<double>(210)};
    return raster;
  };
  EXPECT_THAT(generator_refusal(model, tinier), ::testing::HasSubstr("lies outside the raster"));
}

TEST(GenerateTerrain, AnyThreadCountGivesTheSame) {
  TerrainModel model;
  model.bases = {FractalBase{}, FractalBase{}, dem_base()};
  model.features = {{0, 0, Cone{}}, {1, 2, Pyramid{2, 3, 0.3}}};
  const GridSpec spec = GridSpec::centered(8, 0.125);
  const Grid<double> all = nodes_of(model, spec, slope_raster);
  const ThreadLimit one(1);
  EXPECT_TRUE(std::ranges::equal(all.values(), nodes_of(model, spec, slope_raster).values()));
}

// Two fractal layers of half the variance each are no single layer twice.
TEST(GenerateTerrain, FractalLayersDiffer) {
  TerrainModel one;
  one.bases = {FractalBase{}};
  TerrainModel two;
  two.bases = {FractalBase{}, FractalBase{}};
  const GridSpec spec = GridSpec::centered(4, 1);
  const Grid<double> single = nodes_of(one, spec);
  const Grid<double> both = nodes_of(two, spec);
  EXPECT_GT(std::abs(both.at({4, 4}) - 2 * single.at({4, 4})), 1e-6);
}

// The raster's posting is 1 m: the fractal adds waves shorter than 2 m, wherever it stands in the list, and
// nothing of the raster changes.
TEST(GenerateTerrain, AFractalAddsWhatTheDemLacks) {
  const GridSpec spec = GridSpec::centered(4, 0.25);
  TerrainModel model;
  model.bases = {dem_base()};
  const Grid<double> dem = nodes_of(model, spec, slope_raster);
  const FractalBase law{0.7, 0.3, 1};
  FractalBase band = law;
  band.longest_wavelength_m = 2;
  for (const std::size_t place : {0U, 1U}) {
    model.bases = {dem_base(), dem_base()};
    model.bases[place] = law;
    const Grid<double> both = nodes_of(model, spec, slope_raster);
    Grid<double> expected(spec);
    add_fractal(expected, band, {model.seed, place});
    for (std::size_t i = 0; i < both.values().size(); ++i)
      ASSERT_NEAR(both.values()[i] - dem.values()[i], expected.values()[i], 1e-13);
  }
}

TEST(GenerateTerrain, AFractalWithoutADemHasAllWaves) {
  TerrainModel model;
  model.bases = {FractalBase{}};
  FractalBase all;
  all.longest_wavelength_m = std::numeric_limits<double>::infinity();
  const Grid<double> by_default = nodes_of(model, GridSpec::centered(4, 0.5));
  model.bases = {all};
  EXPECT_TRUE(std::ranges::equal(by_default.values(), nodes_of(model, by_default.spec()).values()));
}

TEST(GenerateTerrain, ProgressRisesToOne) {
  TerrainModel model;
  model.bases = {PlaneBase{}, FractalBase{}};
  std::vector<double> fractions;
  (void)generate_terrain(model, GridSpec::centered(8, 0.5), no_raster,
                         [&](double fraction) { fractions.push_back(fraction); });
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace landfall
