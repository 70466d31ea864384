// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "bins.h"
#include "chain/terrain/relief/albedo_map.h"
#include "chain/terrain/relief/terrain_albedo.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "chain/terrain/relief/terrain_strips.h"
#include "constants.h"
#include "refusal.h"
#include "relief/no_raster.h"

namespace landfall {
namespace {

constexpr GridSpec kSite{0.5, -40, -40, 81, 81};

/// 10 col + 100 row in pixels of 10 m, row 0 in the north, the centre at (2, 2); a hole at `hole`.
DemLoader tens(std::size_t hole = 99) {
  return [hole](const DemBase& dem, const GridSpec&) {
    DemSamples samples{{5, 5}, {}};
    for (int row = 0; row < 5; ++row)
      for (int col = 0; col < 5; ++col) samples.values.push_back(100 * row + 10 * col);
    if (hole < samples.values.size()) samples.values[hole] = kNan;
    return DemRaster{samples,
                     SiteMapping(GeoTransform({0, 10, 0, 0, 0, -10}), {2, 2}, 1),
                     "a crs",
                     {dem.path, "MEM", samples.size, dem.band}};
  };
}

TerrainModel model_with(const AlbedoModel& albedo) {
  TerrainModel model;
  model.albedo = albedo;
  return model;
}

Grid<float> generated_albedo(const AlbedoModel& albedo, const GridSpec& grid = kSite) {
  return generate_terrain(model_with(albedo), grid, tens()).albedo.value();
}

double mean(const Grid<float>& layer) {
  const auto values = layer.values();
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

AlbedoPatches patches(double cover_frac, double longest_m) {
  return {.albedo = 1, .albedo_between = 0, .cover_frac = cover_frac, .longest_wavelength_m = longest_m};
}

TEST(TerrainAlbedo, NoneUnlessTheModelHasOne) {
  EXPECT_FALSE(generate_terrain({}, kSite, no_raster).albedo.has_value());
}

TEST(TerrainAlbedo, ANumberIsThatOfEveryNode) {
  EXPECT_THAT(generated_albedo({.ground = 0.3}).values(), testing::Each(0.3F));
}

TEST(TerrainAlbedo, AGradientSpansTheSite) {
  const Grid<float> east = generated_albedo({.ground = AlbedoGradient{0.2, 0.8}});
  EXPECT_FLOAT_EQ(east.at({3, 0}), 0.2F);
  EXPECT_FLOAT_EQ(east.at({70, 40}), 0.5F);
  EXPECT_FLOAT_EQ(east.at({0, 60}), 0.65F);
  EXPECT_FLOAT_EQ(east.at({0, 80}), 0.8F);
  const Grid<float> north_east = generated_albedo({.ground = AlbedoGradient{0.9, 0.1, std::numbers::pi / 4}});
  EXPECT_FLOAT_EQ(north_east.at({0, 0}), 0.9F);
  EXPECT_FLOAT_EQ(north_east.at({80, 80}), 0.1F);
  EXPECT_FLOAT_EQ(north_east.at({80, 0}), 0.5F);
}

TEST(TerrainAlbedo, AGradientIsConstantBeyondItsLength) {
  const Grid<float> north = generated_albedo({.ground = AlbedoGradient{0, 1, std::numbers::pi / 2, 10.0}});
  for (std::int64_t row = 0; row < 81; ++row)
    EXPECT_NEAR(north.at({row, 17}), std::clamp(0.5 + (static_cast<double>(row) - 40) * 0.5 / 10, 0.0, 1.0),
                1e-6);
}

// The standard deviation of the covered fraction follows from the spectrum; 400 wavelengths^2 make it about
// 0.01.
TEST(TerrainAlbedo, PatchesCoverTheirFraction) {
  const GridSpec grid{0.5, -200, -200, 401, 401};
  for (const double hurst : {0.2, 0.5, 0.9})
    for (const double cover_frac : {0.1, 0.3, 0.5, 0.8}) {
      double sum = 0;
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        AlbedoPatches ground = patches(cover_frac, 10);
        ground.hurst_exponent = hurst;
        TerrainModel model = model_with({.ground = ground});
        model.seed = seed;
        sum += mean(generate_terrain(model, grid, no_raster).albedo.value());
      }
      EXPECT_NEAR(sum / 4, cover_frac, 0.025) << hurst;
    }
  EXPECT_EQ(mean(generated_albedo({.ground = patches(0, 10)})), 0);
  EXPECT_EQ(mean(generated_albedo({.ground = patches(1, 10)})), 1);
}

// A higher cover only adds patches; another seed or wavelength moves them; the same one does not.
TEST(TerrainAlbedo, PatchesDependOnTheSeed) {
  const Grid<float> few = generated_albedo({.ground = patches(0.2, 10)});
  const Grid<float> many = generated_albedo({.ground = patches(0.4, 10)});
  EXPECT_TRUE(std::ranges::equal(few.values(), many.values(), [](float a, float b) { return a <= b; }));
  EXPECT_THAT(generated_albedo({.ground = patches(0.2, 10)}).values(),
              testing::ElementsAreArray(few.values()));
  TerrainModel other = model_with({.ground = patches(0.2, 10)});
  other.seed = 2;
  EXPECT_FALSE(std::ranges::equal(generate_terrain(other, kSite, no_raster).albedo->values(), few.values()));
}

// The patches draw for themselves: the relief is the same with and without them, and not theirs.
TEST(TerrainAlbedo, PatchesChangeNoRelief) {
  TerrainModel rough;
  rough.bases = {FractalBase{0.8, 1, 10, 10}};
  const Grid<double> relief = generate_terrain(rough, kSite, no_raster).nodes;
  rough.albedo = AlbedoModel{.ground = patches(0.5, 10)};
  const GeneratedTerrain both = generate_terrain(rough, kSite, no_raster);
  EXPECT_TRUE(std::ranges::equal(both.nodes.values(), relief.values()));
  std::int64_t agree = 0;
  for (std::size_t i = 0; i < kSite.size(); ++i)
    agree += (relief.values()[i] > 0) == (both.albedo->values()[i] > 0) ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(agree) / static_cast<double>(kSite.size()), 0.5, 0.2);
}

TEST(TerrainAlbedo, PatchesNeedWavesOfTheGrid) {
  const auto longest = [](double longest_m) {
    validate(model_with({.ground = patches(0.5, longest_m)}), kSite);
  };
  EXPECT_NO_THROW(longest(1.01));
  EXPECT_THROW(longest(1), UsageError);
  EXPECT_NO_THROW(longest(40));
  EXPECT_THROW(longest(40.01), UsageError);
}

// Bilinear between the pixels of 10 m: 200 + x in the middle row, 10 per metre to the south.
TEST(TerrainAlbedo, ARasterIsScaled) {
  AlbedoRaster raster{{}, 0.001, 0.1};
  raster.raster.path = "tens";
  raster.raster.interpolation = Interpolation::bilinear;
  const Grid<float> layer = generated_albedo({.ground = raster});
  for (const std::int64_t row : {0, 13, 40, 80})
    for (const std::int64_t col : {0, 27, 80})
      EXPECT_NEAR(layer.at({row, col}), 0.1 + 0.001 * (220 + kSite.x(col) - 10 * kSite.y(row)), 1e-6);
  raster.raster.interpolation = Interpolation::nearest;
  EXPECT_FLOAT_EQ(generated_albedo({.ground = raster}).at({40, 48}), 0.32F);
}

TEST(TerrainAlbedo, ARasterBeyondItsBoundsIsRefused) {
  AlbedoRaster raster{{}, 0.01};
  raster.raster.path = "tens.tif";
  raster.raster.interpolation = Interpolation::bilinear;
  const auto refusal = [&](const DemLoader& load) -> std::string {
    return landfall::refusal<FormatError>(
        [&] { return generate_terrain(model_with({.ground = raster}), kSite, load); });
  };
  EXPECT_EQ(refusal(tens()),
            "tens.tif: the albedo at (-20, -20) m is 4, not in [0, 1]; give "
            "/albedo/ground/scale and /albedo/ground/offset");
  raster.scale = 0.001;
  EXPECT_EQ(refusal(tens()), "accepted");
  EXPECT_EQ(refusal(tens(24)), "tens.tif: the albedo at (10.5, -20) m is missing; give another center");
}

// A hole of the ground needs no albedo, and has none.
TEST(TerrainAlbedo, HolesHaveNone) {
  TerrainModel model = model_with({.ground = 0.4});
  DemBase dem;
  dem.path = "holes";
  dem.interpolation = Interpolation::nearest;
  dem.datum = Datum::none;
  model.bases = {dem};
  const GeneratedTerrain terrain = generate_terrain(model, kSite, tens(0));
  std::int64_t holes = 0;
  for (std::size_t i = 0; i < kSite.size(); ++i) {
    const bool is_hole = std::isnan(terrain.nodes.values()[i]);
    holes += is_hole ? 1 : 0;
    EXPECT_EQ(std::isnan(terrain.albedo->values()[i]), is_hole);
  }
  EXPECT_GT(holes, 0);
}

std::size_t kind_of(const FeatureShape& shape) { return shape.index(); }

// A pit below, a ridge over it, a cone upon both; the rock has no albedo and is not seen in the layer.
TEST(FeatureAlbedo, TheOneThatMakesTheSurfaceCounts) {
  AlbedoModel albedo{.ground = 0.5};
  albedo.of_kind[kind_of(Pit{})] = 0.1;
  albedo.of_kind[kind_of(Ridge{})] = 0.2;
  albedo.of_kind[kind_of(Cone{})] = 0.9;
  TerrainModel model = model_with(albedo);
  model.features = {
      {0, 0, Cone{3, 4}}, {0, 0, Pit{16, 1}}, {0, 0, Ridge{30, 2, 0.5, 0, 3}}, {12, 12, Rock{4, 2}}};
  const GeneratedTerrain terrain = generate_terrain(model, kSite, no_raster);
  const auto at = [&](double x_m, double y_m) { return terrain.albedo->at(kSite.bin_of(x_m, y_m)); };
  EXPECT_EQ(at(0, 0), 0.9F);
  EXPECT_EQ(at(2, 0), 0.9F);
  EXPECT_EQ(at(0, 7), 0.1F);
  EXPECT_EQ(at(6, 0), 0.2F);   // on the ridge, beyond the cone
  EXPECT_EQ(at(12, 0), 0.2F);  // and beyond the pit
  EXPECT_EQ(at(12, 12), 0.5F);
  EXPECT_EQ(at(-15, 15), 0.5F);
}

// For two cones, the higher surface at a node decides, whatever their order.
TEST(FeatureAlbedo, TheHigherOfTwoStandingFeatures) {
  AlbedoModel albedo{.ground = 0.5};
  albedo.of_kind[kind_of(Hemisphere{})] = 0.1;
  albedo.of_kind[kind_of(Cone{})] = 0.9;
  TerrainModel model = model_with(albedo);
  model.features = {{0, 0, Hemisphere{3}}, {0, 0, Cone{1, 10}}, {10, 0, Cone{1, 10}}, {10, 0, Hemisphere{3}}};
  const GeneratedTerrain terrain = generate_terrain(model, kSite, no_raster);
  for (const double x_m : {0.0, 10.0}) {
    EXPECT_EQ(terrain.albedo->at(kSite.bin_of(x_m, 0)), 0.9F);
    EXPECT_EQ(terrain.albedo->at(kSite.bin_of(x_m + 2, 0)), 0.1F);
  }
}

// Strips of any height give the same layer, and one whose fractal suits large grids.
TEST(TerrainAlbedo, StripsChangeNothing) {
  const GridSpec grid{0.5, -303, -150, 607, 301};
  AlbedoModel albedo{.ground = patches(0.3, 60)};
  albedo.of_kind[kind_of(Hemisphere{})] = 0.25;
  TerrainModel model = model_with(albedo);
  model.features = {{3, 40, Hemisphere{60}}};
  const auto made = [&](std::int64_t rows) {
    Grid<float> whole(grid);
    TerrainStrips strips(model, grid, no_raster, {1000, rows});
    EXPECT_TRUE(strips.has_albedo());
    strips.make([&](const TerrainStrip& strip) {
      const std::int64_t first = strip.albedo->spec().first_row - grid.first_row;
      std::ranges::copy(strip.albedo->values(), whole.row(first).begin());
    });
    return whole;
  };
  const Grid<float> one = made(grid.rows);
  for (const std::int64_t rows : {4, 64, 101})
    EXPECT_THAT(made(rows).values(), testing::ElementsAreArray(one.values()));
  EXPECT_EQ(one.at(grid.bin_of(3, 40)), 0.25F);
  const auto ones = std::ranges::count(one.values(), 1.0F);
  const auto zeros = std::ranges::count(one.values(), 0.0F);
  EXPECT_NEAR(static_cast<double>(ones) / static_cast<double>(ones + zeros), 0.3, 0.1);
}

TEST(TerrainAlbedo, ValidatesItsParameters) {
  const auto refused = [](const AlbedoModel& albedo) {
    EXPECT_THROW(validate(model_with(albedo)), UsageError);
  };
  refused({.ground = 1.01});
  refused({.ground = AlbedoGradient{-0.1, 1}});
  refused({.ground = AlbedoGradient{0, kNan}});
  refused({.ground = AlbedoGradient{0, 1, kNan}});
  refused({.ground = AlbedoGradient{0, 1, 0, 0.0}});
  refused({.ground = AlbedoPatches{.albedo = 2}});
  refused({.ground = AlbedoPatches{.albedo_between = 2}});
  refused({.ground = patches(1.5, 10)});
  refused({.ground = patches(0.5, 0)});
  refused({.ground = AlbedoPatches{.hurst_exponent = 1}});
  refused({.ground = AlbedoRaster{}});
  AlbedoModel dark_rocks;
  dark_rocks.of_kind[kind_of(Rock{})] = -0.1;
  refused(dark_rocks);
}

constexpr GridSpec kNodes{0.5, -5, -3, 10, 7};

float albedo_of(double x_m, double y_m) { return static_cast<float>(0.5 + 0.01 * x_m + 0.1 * y_m); }

/// Loads albedo_of() at the nodes, and records the windows.
AlbedoMap map_of(std::vector<GridSpec>& windows, const BinIndex& tile) {
  return {kNodes, tile, [&windows](const GridSpec& window) {
            windows.push_back(window);
            return grid_of<float>(window, albedo_of);
          }};
}

TEST(AlbedoMap, IsThatOfTheNearestNode) {
  for (const BinIndex& tile : {BinIndex{4, 3}, BinIndex{1, 1}, BinIndex{256, 256}}) {
    std::vector<GridSpec> windows;
    const AlbedoMap map = map_of(windows, tile);
    for (const auto [row, col] : bins_of(kNodes))
      for (const double off_m : {-0.24, 0.0, 0.24})
        EXPECT_EQ(map.at(kNodes.x(col) + off_m, kNodes.y(row) - off_m),
                  static_cast<double>(albedo_of(kNodes.x(col), kNodes.y(row))));
  }
}

TEST(AlbedoMap, LoadsATileOnceAndOnlyIfNeeded) {
  std::vector<GridSpec> windows;
  const AlbedoMap map = map_of(windows, {4, 3});
  EXPECT_TRUE(windows.empty());
  static_cast<void>(map.at(-1.5, -2.5));
  static_cast<void>(map.at(-0.5, -1));
  EXPECT_EQ(windows, (std::vector<GridSpec>{{0.5, -5, -3, 4, 3}}));
  static_cast<void>(map.at(1.5, 2));
  EXPECT_EQ(windows.back(), (GridSpec{0.5, 3, 3, 2, 1}));
  EXPECT_EQ(windows.size(), 2);
}

TEST(AlbedoMap, OffTheTerrainThereIsNone) {
  std::vector<GridSpec> windows;
  const AlbedoMap map = map_of(windows, {4, 3});
  for (const auto& [x_m, y_m] : {std::pair{-1.76, 0.0}, {1.76, 0.0}, {0.0, -2.76}, {0.0, 2.26}, {NAN, 0.0}})
    EXPECT_TRUE(std::isnan(map.at(x_m, y_m)));
  EXPECT_TRUE(windows.empty());
}

TEST(AlbedoMap, AnyThreadMayAsk) {
  std::vector<GridSpec> windows;
  const AlbedoMap map = map_of(windows, {1, 1});
  parallel_for(10000, 7, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto node = static_cast<std::int64_t>((i * 37) % kNodes.size());
      const double x_m = kNodes.x(node % kNodes.cols);
      const double y_m = kNodes.y(node / kNodes.cols);
      ASSERT_EQ(map.at(x_m, y_m), static_cast<double>(albedo_of(x_m, y_m)));
    }
  });
  EXPECT_EQ(windows.size(), kNodes.size());
}

TEST(AlbedoMap, PassesTheLoadersErrorOn) {
  const AlbedoMap map(kNodes, {4, 3}, [](const GridSpec&) -> Grid<float> { throw FormatError("bad"); });
  EXPECT_THROW(static_cast<void>(map.at(0, 0)), FormatError);
  EXPECT_THROW(static_cast<void>(map.at(0, 0)), FormatError);
}

}  // namespace
}  // namespace landfall
