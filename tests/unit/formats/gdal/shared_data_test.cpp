// SPDX-License-Identifier: GPL-3.0-or-later
// Real rasters, from $LANDFALL_DATA or the shared data beside the repository; skipped where neither is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "base/core/error.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "formats/gdal/gdal_loader.h"
#include "gdal_rasters.h"
#include "shared_data.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

class SharedData : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(shared_data() / "dem"))
      GTEST_SKIP() << "no real rasters: " << shared_data() / "dem"
                   << " (LANDFALL_DATA)";
  }
};

DemBase dem_of(const std::string& name) {
  DemBase dem;
  dem.path = (shared_data() / name).string();
  dem.datum = Datum::none;
  return dem;
}

GeneratedTerrain shared_terrain(const DemBase& dem, const GridSpec& spec) {
  TerrainModel model;
  model.bases = {dem};
  return generate_terrain(model, spec, dem_loader(RasterLinks::followed));
}

std::int64_t hole_count(const Grid<double>& z) {
  return std::ranges::count_if(z.values(), [](double v) { return std::isnan(v); });
}

double lowest(const Grid<double>& z) { return *std::ranges::min_element(z.values()); }
double highest(const Grid<double>& z) { return *std::ranges::max_element(z.values()); }

// 513 x 513 pixels of 10 m: all of it, at its own posting, holds the range that SOURCES.md gives.
TEST_F(SharedData, Europa) {
  const GeneratedTerrain terrain =
      shared_terrain(dem_of("dem/europa_e26_terminator_10m.tif"), GridSpec::centered(2560, 10));
  EXPECT_EQ(hole_count(terrain.nodes), 0);
  EXPECT_NEAR(lowest(terrain.nodes), -57.1, 0.1);
  EXPECT_NEAR(highest(terrain.nodes), 63.7, 0.1);
  EXPECT_EQ(terrain.dem_sources[0].size, (RasterSize{513, 513}));
  EXPECT_THAT(terrain.crs_wkt, ::testing::HasSubstr("1561500"));
}

TEST_F(SharedData, MarsGale) {
  const GeneratedTerrain terrain =
      shared_terrain(dem_of("dem/mars_gale_hirise_1m.tif"), GridSpec::centered(160, 1));
  EXPECT_EQ(hole_count(terrain.nodes), 0);
  EXPECT_GE(lowest(terrain.nodes), -4473);
  EXPECT_LE(highest(terrain.nodes), -4437);
}

TEST_F(SharedData, MoonNorthPole) {
  DemBase dem = dem_of("dem/moon_npole_2m4_80m.tif");
  EXPECT_THROW((void)load_dem(dem, GridSpec::centered(39, 1)), FormatError);  // 32 x 2.4266 m / 2 = 38.8 m
  const GeneratedTerrain terrain = shared_terrain(dem, GridSpec::centered(38, 0.5));
  EXPECT_GE(lowest(terrain.nodes), -213);
  EXPECT_LE(highest(terrain.nodes), -205);
  dem.datum = Datum::center;
  EXPECT_EQ(shared_terrain(dem, GridSpec::centered(38, 0.5)).nodes.at({76, 76}), 0);
}

// Raw numbers are half metres, coordinates are degrees: (-157, 5.4), the highest place of the Moon.
TEST_F(SharedData, MoonGlobalInDegreesWithScale) {
  DemBase dem = dem_of("dem/moon_lola_global_int16_scale0.5_latlon.tif");
  dem.center = {-157.0, 5.4};
  const GeneratedTerrain west = shared_terrain(dem, GridSpec::centered(300000, 10000));
  EXPECT_GT(highest(west.nodes), 9500);
  EXPECT_LT(highest(west.nodes), 10628);
  dem.center = {203.0, 5.4};
  EXPECT_TRUE(std::ranges::equal(west.nodes.values(),
                                 shared_terrain(dem, GridSpec::centered(300000, 10000)).nodes.values()));
  const MapPoint origin = site_to_crs(west.crs_wkt, {0, 0}, "+proj=longlat +R=1737400");
  EXPECT_NEAR(origin.x, -157, 1e-9);
  EXPECT_NEAR(origin.y, 5.4, 1e-9);
}

TEST_F(SharedData, MarsMolaBigEndian) {
  DemBase dem = dem_of("dem/mars_mola_megt90n000cb.vrt");
  dem.center = {-133.8, 18.65};  // Olympus Mons, 226.2 E, in a raster of 0..360
  const GeneratedTerrain olympus = shared_terrain(dem, GridSpec::centered(300000, 10000));
  EXPECT_NEAR(highest(olympus.nodes), 21134, 300);
}

TEST_F(SharedData, Apollo15Png) {
  DemBase dem = dem_of("dem/moon_apollo15_nac_2m_8bit.png");
  EXPECT_THROW((void)load_dem(dem, GridSpec::centered(256, 2)), UsageError);
  dem.horizontal_scale_m = 2;
  dem.vertical_scale = 0.192;
  const GeneratedTerrain terrain = shared_terrain(dem, GridSpec::centered(256, 2));
  EXPECT_GE(lowest(terrain.nodes), -1e-9);
  EXPECT_LE(highest(terrain.nodes), 0.192 * 255 + 1e-9);
  EXPECT_GT(highest(terrain.nodes), 40);
}

TEST_F(SharedData, StHelensNodataNonSquare) {
  const GeneratedTerrain terrain =
      shared_terrain(dem_of("dem/earth_sthelens_nodata_int16_nonsquare.dem"), GridSpec::centered(4800, 50));
  EXPECT_GT(hole_count(terrain.nodes), 0);
  for (const double z : terrain.nodes.values()) EXPECT_TRUE(std::isnan(z) || (z > 500 && z < 3000)) << z;
}

TEST_F(SharedData, BijouAsciiGrid) {
  DemBase dem = dem_of("dem/earth_bijou_gully_5m.asc");
  dem.horizontal_scale_m = 1;
  const GeneratedTerrain terrain = shared_terrain(dem, GridSpec::centered(180, 2));
  EXPECT_GE(lowest(terrain.nodes), 1670);
  EXPECT_LE(highest(terrain.nodes), 1733);
  EXPECT_EQ(terrain.dem_sources[0].driver, "AAIGrid");
}

// 31 x 31 pixels, 171 holes: as many at the raster's own posting, by any interpolation.
TEST_F(SharedData, EarthReliefKeepsItsHoles) {
  DemBase dem = dem_of("dem/earth_relief_20arcmin_holes.grd");
  dem.horizontal_scale_m = 3;  // a pixel of 1/3 degree becomes 1 m
  for (const auto method : {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    dem.interpolation = method;
    EXPECT_EQ(hole_count(shared_terrain(dem, GridSpec::centered(15, 1)).nodes), 171);
  }
}

}  // namespace
}  // namespace landfall
