// SPDX-License-Identifier: GPL-3.0-or-later
// The rasters of testdata/: each holds a formula of its map's coordinates (testdata/README.md), which the
// loaded terrain must return.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "chain/terrain/relief/structure_function.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "formats/gdal/gdal_loader.h"
#include "gdal_rasters.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

const fs::path kTestdata = LANDFALL_TESTDATA;
const std::string kMoonDegrees = "+proj=longlat +R=1737400 +no_defs";
const std::string kMarsDegrees = "+proj=longlat +R=3396190 +no_defs";
const std::string kMoonNorth = "+proj=stere +lat_0=90 +lon_0=0 +k=1 +R=1737400 +units=m +no_defs";
const std::string kMarsMap = "+proj=eqc +R=3396190 +units=m +no_defs";
const std::string kUtm = "EPSG:32631";

/// A raster whose elevation is z0 + a X + b Y + c X Y, X and Y from `middle` in its map's units.
struct Ground {
  std::string file;
  std::string crs;  ///< of its map; none where `metres_per_unit` is given
  MapPoint middle;
  double z0 = 0;
  double a = 0;
  double b = 0;
  double c = 0;
  double half_width_m = 0;
  double resolution_m = 0;
  std::optional<MapPoint> center;  ///< of the site on the map; the raster's middle if empty
  std::optional<double> metres_per_unit;
  int band = 1;
  double smallest_x = -1e9;  ///< of the map: 0 where longitudes go from 0 to 360

  [[nodiscard]] double elevation(const MapPoint& point) const {
    const double x = point.x - middle.x;
    const double y = point.y - middle.y;
    return z0 + a * x + b * y + c * x * y;
  }
  [[nodiscard]] MapPoint site_center() const { return center.value_or(middle); }
};

std::vector<Ground> terrains() {
  const MapPoint utm{500000, 4000000};
  return {
      {"big_endian_int16.tif", kUtm, utm, 1, 300, -500, 0, 8, 0.5, {}, {}},
      {"cell.dt0", "EPSG:4326", {9.5, 43.5}, 300, 600, 840, 0, 20000, 1000, MapPoint{9.4, 43.4}, {}},
      {"float16.tif", kUtm, utm, 64, 0.125, -0.25, 0, 500, 25, {}, {}},
      {"gmt_holes.grd", "", {20, 40}, -2000, 150, -90, 9, 10, 0.25, {}, 3},
      {"grey_8bit.png", "", {16.5, 16.5}, 112, 3, 4, 0, 30, 1, {}, 2},
      {"latlon_scaled_int16.tif", kMoonDegrees, {30, 0.5}, 500, 100, -60, 400, 40000, 1000, {}, {}},
      {"mars_big_endian.vrt",
       kMarsDegrees,
       {180, 0},
       -1000,
       20,
       36,
       0,
       600000,
       50000,
       MapPoint{-133.8, 18.65},
       {},
       1,
       0},
      {"mosaic.vrt", kUtm, utm, 700, 0.2, -0.4, 0, 130, 5, {}, {}},
      {"nan_nodata_deflate.tif", kUtm, utm, 6, 1, 2, 0, 3, 0.5, {}, {}},
      {"nodata_no_crs.asc", "", {1011.5, 2009.5}, 100, 0.5, 0.75, -0.125, 16, 0.5, {}, 2},
      {"nonsquare_int16.tif", kUtm, utm, 1500, 0.02, -0.04, 0, 3500, 50, {}, {}},
      {"polar_stereographic.tif",
       kMoonNorth,
       {-53000, -51000},
       -208,
       0.125,
       -0.0625,
       0.0078125,
       35,
       0.5,
       {},
       {}},
      {"rotated.tif", kUtm, utm, 12, 0.5, 0.25, 0, 75, 5, {}, {}},
      {"south_up.tif", kMarsMap, {270000, -120000}, -4400, 0.25, -0.125, 0.015625, 90, 2.5, {}, {}},
      {"three_bands_minus_inf.tif", kUtm, utm, 50, 2, -3, 0.25, 9, 0.5, {}, {}, 2},
      {"vicar_int16.vic", "", {10.5, 7.5}, -40, 700, 90, 0, 18, 1, {}, 3},
  };
}

class Testdata : public ::testing::TestWithParam<Ground> {
 protected:
  static GeneratedTerrain load(Interpolation interpolation) {
    const Ground& ground = GetParam();
    DemBase dem;
    dem.path = (kTestdata / "rasters" / ground.file).string();
    dem.band = ground.band;
    dem.datum = Datum::none;
    dem.interpolation = interpolation;
    dem.horizontal_scale_m = ground.metres_per_unit;
    dem.center = {ground.site_center().x, ground.site_center().y};
    TerrainModel model;
    model.bases = {dem};
    return generate_terrain(model, GridSpec::centered(ground.half_width_m, ground.resolution_m),
                            dem_loader(RasterLinks::followed));
  }
  static std::vector<MapPoint> map_points(const GeneratedTerrain& terrain,
                                          const std::vector<SitePoint>& places) {
    const Ground& ground = GetParam();
    std::vector<MapPoint> points;
    if (ground.metres_per_unit) {
      const double units_per_metre = 1 / *ground.metres_per_unit;
      for (const SitePoint& place : places)
        points.push_back({ground.site_center().x + place.x_m * units_per_metre,
                          ground.site_center().y + place.y_m * units_per_metre});
      return points;
    }
    points = site_to_crs(terrain.crs_wkt, places, ground.crs);
    for (MapPoint& point : points)
      if (point.x < ground.smallest_x) point.x += 360;
    return points;
  }
};

/// Six nodes by six; bilinear and bicubic interpolation both reproduce the formula.
TEST_P(Testdata, LoadsWithItsElevations) {
  for (const Interpolation interpolation : {Interpolation::bilinear, Interpolation::bicubic}) {
    const GeneratedTerrain terrain = load(interpolation);
    const GridSpec& spec = terrain.nodes.spec();
    std::vector<SitePoint> places;
    std::vector<double> elevations;
    for (std::int64_t row = 0; row < spec.rows; row += (spec.rows - 1) / 5) {
      for (std::int64_t col = 0; col < spec.cols; col += (spec.cols - 1) / 5) {
        if (std::isnan(terrain.nodes.at({row, col}))) continue;
        places.push_back({spec.x(col), spec.y(row)});
        elevations.push_back(terrain.nodes.at({row, col}));
      }
    }
    EXPECT_GE(places.size(), 20U);
    const std::vector<MapPoint> points = map_points(terrain, places);
    for (std::size_t i = 0; i < places.size(); ++i)
      ASSERT_NEAR(elevations[i], GetParam().elevation(points[i]), 1e-6)
          << "x " << places[i].x_m << " m, y " << places[i].y_m << " m: " << points[i].x << ", "
          << points[i].y;
  }
}

INSTANTIATE_TEST_SUITE_P(Rasters, Testdata, ::testing::ValuesIn(terrains()), [](const auto& tested) {
  std::string name = tested.param.file;
  std::ranges::replace(name, '.', '_');
  return name;
});

/// A site on the raster's own pixels.
Grid<double> pixels(const std::string& file, PixelPosition center, const GridSpec& spec,
                    double metres_per_unit, int band = 1) {
  DemBase dem;
  dem.path = (kTestdata / "rasters" / file).string();
  dem.band = band;
  dem.interpolation = Interpolation::nearest;
  dem.datum = Datum::none;
  if (metres_per_unit > 0) dem.horizontal_scale_m = metres_per_unit;
  dem.center_pixel = {center.col, center.row};
  TerrainModel model;
  model.bases = {dem};
  return generate_terrain(model, spec, load_dem).nodes;
}

/// (column, row) of the holes of a square raster of odd size, or of the square about `center` in it.
std::vector<std::pair<int, int>> holes(const Grid<double>& nodes, int center_col, int center_row) {
  std::vector<std::pair<int, int>> found;
  const std::int64_t half = (nodes.spec().rows - 1) / 2;
  for (std::int64_t row = nodes.spec().rows - 1; row >= 0; --row)
    for (std::int64_t col = 0; col < nodes.spec().cols; ++col)
      if (std::isnan(nodes.at({row, col})))
        found.emplace_back(center_col + static_cast<int>(col - half),
                           center_row - static_cast<int>(row - half));
  return found;
}

TEST(TestdataHoles, LieWhereTheFileHasThem) {
  using Places = std::vector<std::pair<int, int>>;
  EXPECT_EQ(holes(pixels("three_bands_minus_inf.tif", {12, 10}, GridSpec::centered(10, 1), 0, 2), 12, 10),
            (Places{{3, 4}, {20, 15}}));
  EXPECT_EQ(holes(pixels("nodata_no_crs.asc", {9, 9}, GridSpec::centered(9, 1), 1), 9, 9),
            (Places{{0, 0}, {5, 9}}));
  EXPECT_EQ(holes(pixels("nan_nodata_deflate.tif", {5, 5}, GridSpec::centered(4, 1), 0), 5, 5),
            (Places{{2, 3}, {9, 8}}));
  Places discs;
  for (int row = 0; row < 31; ++row)  // the file's rows go from the south
    for (int col = 0; col < 31; ++col)
      if (std::hypot(30 - row - 9, col - 8) < 4.5 || std::hypot(30 - row - 22, col - 20) < 5.5)
        discs.emplace_back(col, row);
  EXPECT_EQ(holes(pixels("gmt_holes.grd", {15, 15}, GridSpec::centered(15, 1), 3), 15, 15), discs);
}

// Hurst exponent: the slope of log deviation against log distance, by least squares over 1 .. 8 postings.
double hurst_exponent(const Grid<double>& z) {
  const std::vector<std::int64_t> lags = {1, 2, 3, 4, 6, 8};
  double x = 0;
  double y = 0;
  double xx = 0;
  double xy = 0;
  for (const std::int64_t lag : lags) {
    const double u = std::log(static_cast<double>(lag));
    const double v = std::log(std::sqrt(squared_deviation(z, lag)));
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  const auto n = static_cast<double>(lags.size());
  return (n * xy - x * y) / (n * xx - x * x);
}

TEST(TestdataRelief, HasTheStatisticsOfItsBody) {
  const Grid<double> europa = pixels("relief_europa_10m.tif", {52, 52}, GridSpec::centered(520, 10), 0);
  EXPECT_NEAR(std::sqrt(squared_deviation(europa, 1)), 2.13, 0.001);
  EXPECT_NEAR(hurst_exponent(europa), 0.8, 0.03);
  const Grid<double> moon = pixels("relief_moon_1m.tif", {64, 64}, GridSpec::centered(64, 1), 0);
  EXPECT_NEAR(std::sqrt(squared_deviation(moon, 17)), 0.88, 0.001);
  EXPECT_NEAR(hurst_exponent(moon), 0.76, 0.03);
}

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

/// Imports the smallest site there is, with a scale where the file has no CRS; the error's text, or
/// "accepted".
std::string outcome(const fs::path& file) {
  DemBase dem;
  dem.path = file.string();
  dem.interpolation = Interpolation::nearest;
  dem.datum = Datum::none;
  for (const bool scaled : {false, true}) {
    if (scaled) dem.horizontal_scale_m = 1;
    try {
      TerrainModel model;
      model.bases = {dem};
      (void)generate_terrain(model, GridSpec::centered(1, 1), dem_loader(RasterLinks::followed));
      return "accepted";
    } catch (const UsageError& error) {
      if (scaled) return error.what();
    } catch (const Error& error) {
      return error.what();
    }
  }
  return "unreachable";
}

TEST(TestdataMalformed, IsRefusedQuicklyAndInLittleMemory) {
  (void)outcome("first, so that GDAL itself is not counted");
  const std::size_t before = peak_memory_bytes();
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(kTestdata / "malformed")) {
    const fs::path& file = entry.path();
    const std::clock_t start = std::clock();  // processor time, which other programs do not change
    const std::string result = outcome(file);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    EXPECT_THAT(result, ::testing::StartsWith(file.string() + ": "));
    EXPECT_LT(seconds, 2) << file;
    EXPECT_LT(peak_memory_bytes() - before, 200U << 20U) << file;
    ++count;
  }
  EXPECT_GE(count, 40U);
}

}  // namespace
}  // namespace landfall
