// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/gdal/gdal_loader.h"

#include <gdal.h>
#include <gdal_frmts.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "base/core/error.h"
#include "bins.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "chain/terrain/site_wkt.h"
#include "constants.h"
#include "formats/gdal/map_frame.h"
#include "gdal_rasters.h"
#include "load_dem_test.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kRadians = std::numbers::pi / 180;

TEST_F(LoadDem, TellsItsFiles) {
  DemBase dem = written({4, 4, [](int col, int) { return col; }});
  const std::string raster = dem.path;
  RasterLinks links = RasterLinks::followed;
  const auto files = [&](const std::string& path) {
    dem.path = path;
    return dem_files(dem, links);
  };
  const auto write = [&](const std::string& name, const std::string& source) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path)
        << R"(<VRTDataset rasterXSize="4" rasterYSize="4"><VRTRasterBand dataType="Float32" band="1">
      <SimpleSource><SourceFilename relativeToVRT="1">)"
        << source << R"(</SourceFilename><SourceBand>1</SourceBand>
      <SourceProperties RasterXSize="4" RasterYSize="4" DataType="Float32" BlockXSize="4" BlockYSize="4"/>
      </SimpleSource></VRTRasterBand></VRTDataset>)";
    return path;
  };
  const std::string vrt = write("a.vrt", "raster.tif");
  const std::string outer = write("b.vrt", "a.vrt");
  EXPECT_THAT(files(raster), ::testing::ElementsAre(raster));
  EXPECT_THAT(files("GTIFF_DIR:1:" + raster), ::testing::Contains(raster));
  EXPECT_THAT(files("NETCDF:\"" + raster + "\":z"), ::testing::Contains(raster));
  EXPECT_THAT(files("/vsigzip/" + raster), ::testing::Contains(raster));
  EXPECT_THAT(files(vrt), ::testing::UnorderedElementsAre(vrt, raster));
  EXPECT_THAT(files(outer), ::testing::UnorderedElementsAre(outer, vrt, raster));
  const std::string circle = write("c.vrt", "c.vrt");
  EXPECT_THAT(files(circle), ::testing::ElementsAre(circle));
  EXPECT_THAT(files("/nowhere/x.tif"), ::testing::IsEmpty());
  links = RasterLinks::refused;
  // GDAL tells the sources that a VRT names, but what they name in turn it could only know by opening them.
  EXPECT_THAT(files(outer), AllOf(::testing::Contains(outer), ::testing::Not(::testing::Contains(raster))));
}

TEST_F(LoadDem, RefusesAPipe) {
  DemBase dem = written({4, 4, [](int col, int) { return col; }});
  const std::string pipe = (folder_ / "pipe.tif").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string vrt = (folder_ / "pipe.vrt").string();
  std::ofstream(vrt)
      << R"(<VRTDataset rasterXSize="4" rasterYSize="4"><VRTRasterBand dataType="Float32" band="1">
      <SimpleSource><SourceFilename relativeToVRT="1">pipe.tif</SourceFilename><SourceBand>1</SourceBand>
      </SimpleSource></VRTRasterBand></VRTDataset>)";
  for (const std::string& path : {pipe, vrt}) {
    dem.path = path;
    EXPECT_THAT([&] { (void)dem_loader(RasterLinks::followed)(dem, GridSpec::centered(1, 1)); },
                ::testing::ThrowsMessage<FormatError>(pipe + ": is not a regular file"));
  }
}

GeneratedTerrain terrain_of(const DemBase& dem, const GridSpec& spec) {
  TerrainModel model;
  model.bases = {dem};
  return generate_terrain(model, spec, load_dem);
}

/// The error of an import, its kind first.
std::string import_refusal(const DemBase& dem, const GridSpec& spec) {
  return kind_and_refusal([&] { return load_dem(dem, spec); });
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The values that a raster must store so that z = 7 + 2 x - 3 y, (x, y) in map units.
std::function<double(int, int)> map_plane(const std::array<double, 6>& transform) {
  return [g = GeoTransform(transform)](int col, int row) {
    const MapPoint p = g.map_point({static_cast<double>(col), static_cast<double>(row)});
    return 7 + 2 * p.x - 3 * p.y;
  };
}

void expect_plane(const Grid<double>& z, double at_centre, double per_x, double per_y) {
  const GridSpec& spec = z.spec();
  for (const auto [r, c] : bins_of(spec))
    ASSERT_NEAR(z.at({r, c}), at_centre + per_x * spec.x(c) + per_y * spec.y(r), 1e-8) << r << ' ' << c;
}

// Every cell shape must give the same ground: z = 7 + 2 x - 3 y of the map, east and north kept apart.
class CellShape : public LoadDem, public ::testing::WithParamInterface<std::array<double, 6>> {};

TEST_P(CellShape, GivesTheSameGround) {
  DemBase dem = written({40, 50, map_plane(GetParam()), "Float64", GetParam(), "EPSG:32631"});
  const MapPoint middle = GeoTransform(GetParam()).map_point({19.5, 24.5});
  const GridSpec spec = GridSpec::centered(12, 0.5);
  expect_plane(terrain_of(dem, spec).nodes, 7 + 2 * middle.x - 3 * middle.y, 2, -3);
  dem.center = {middle.x + 3, middle.y - 2};
  expect_plane(terrain_of(dem, spec).nodes, 7 + 2 * (middle.x + 3) - 3 * (middle.y - 2), 2, -3);
  dem.center.reset();
  dem.center_pixel = {20, 24};
  const MapPoint pixel = GeoTransform(GetParam()).map_point({20, 24});
  expect_plane(terrain_of(dem, spec).nodes, 7 + 2 * pixel.x - 3 * pixel.y, 2, -3);
}

INSTANTIATE_TEST_SUITE_P(
    All, CellShape,
    ::testing::Values(std::array<double, 6>{500000, 1, 0, 4000000, 0, -1},          // north-up
                      std::array<double, 6>{500000, 1, 0, 4000000, 0, 1},           // south-up
                      std::array<double, 6>{500000, 1.5, 0, 4000000, 0, -0.75},     // not square
                      std::array<double, 6>{500000, 0.8, 0.6, 4000000, 0.6, -0.8},  // rotated
                      std::array<double, 6>{500000, 0, 1, 4000000, 1, 0}));         // turned by 90 deg

TEST_F(LoadDem, ProjectedCrsIsShifted) {
  const std::array<double, 6> transform{500000, 10, 0, 4000000, 0, -10};
  const DemRaster raster = load_dem(
      written({30, 30, map_plane(transform), "Float32", transform, "EPSG:32631"}), GridSpec::centered(50, 5));
  const MapPoint origin = site_to_crs(raster.crs_wkt, {0, 0}, "EPSG:32631");
  EXPECT_NEAR(origin.x, 500150, 1e-3);
  EXPECT_NEAR(origin.y, 3999850, 1e-3);
  const MapPoint north_east = site_to_crs(raster.crs_wkt, {30, 40}, "EPSG:32631");
  EXPECT_NEAR(north_east.x, 500180, 1e-3);
  EXPECT_NEAR(north_east.y, 3999890, 1e-3);
  EXPECT_EQ(raster.source.driver, "GTiff");
  EXPECT_EQ(raster.source.size, (RasterSize{30, 30}));
  EXPECT_EQ(raster.source.band, 1);
}

// EPSG:2225, California zone 1, US survey feet: 1 ft = 1200/3937 m.
TEST_F(LoadDem, FeetBecomeMetres) {
  const std::array<double, 6> transform{6000000, 10, 0, 2000000, 0, -10};
  const DemBase dem = written({41, 41, map_plane(transform), "Float64", transform, "EPSG:2225"});
  const GeneratedTerrain terrain = terrain_of(dem, GridSpec::centered(48, 4));
  const double feet_per_metre = 3937.0 / 1200;
  expect_plane(terrain.nodes, 7 + 2 * 6000205 - 3 * 1999795.0, 2 * feet_per_metre, -3 * feet_per_metre);
  const MapPoint east = site_to_crs(terrain.crs_wkt, {12, 0}, "EPSG:2225");
  EXPECT_NEAR(east.x, 6000205 + 12 * feet_per_metre, 1e-2);
  EXPECT_NEAR(east.y, 1999795, 1e-2);
  EXPECT_THAT(import_refusal(dem, GridSpec::centered(64, 4)),
              HasSubstr("half_width_m of 60 "));  // 200 ft = 60.96 m
}

// int16, nodata judged before scale and offset: -32768 would be -16374 m, 10 is nodata of no one.
TEST_F(LoadDem, ScaleOffsetAndNodata) {
  TestRaster raster{5,       5,   [](int c, int r) { return c == 1 && r == 3 ? -32768 : 10 * c + r; },
                    "Int16", {},  "",
                    -32768,  0.5, 10,
                    {}};
  DemBase dem = written(raster);
  dem.horizontal_scale_m = 2;
  const Grid<double> z = terrain_of(dem, GridSpec::centered(4, 2)).nodes;
  EXPECT_EQ(z.at({4, 0}), 10);             // column 0, row 0
  EXPECT_EQ(z.at({0, 4}), 0.5 * 44 + 10);  // column 4, row 4
  EXPECT_TRUE(std::isnan(z.at({1, 1})));
  EXPECT_EQ(std::ranges::count_if(z.values(), [](double v) { return std::isnan(v); }), 1);
}

DemRaster five_by_five(const DemBase& dem) { return load_dem(dem, GridSpec::centered(2, 1)); }

TEST_F(LoadDem, EveryKindOfHoleIsNan) {
  const auto hole_at_7 = [](const DemRaster& raster) {
    for (std::size_t i = 0; i < 25; ++i)
      if (std::isnan(raster.samples.values[i]) != (i == 7)) return false;
    return true;
  };
  const auto with = [](double special) {
    return [special](int c, int r) { return 5 * r + c == 7 ? special : 1.0 * c; };
  };
  const auto imported = [&](const TestRaster& raster) {
    DemBase dem = written(raster);
    dem.horizontal_scale_m = 1;
    return five_by_five(dem);
  };
  EXPECT_TRUE(hole_at_7(imported({5, 5, with(kNan), "Float32"})));
  EXPECT_TRUE(hole_at_7(imported({5, 5, with(kNan), "Float64", {}, "", kNan, 1, 0, {}})));
  EXPECT_TRUE(hole_at_7(imported({5, 5, with(-HUGE_VAL), "Float32"})));
  // The nodata text of many planetary rasters, which equals the pixel in float only.
  EXPECT_TRUE(hole_at_7(
      imported({5, 5, with(-3.4028226550889045e38), "Float32", {}, "", -3.40282265508890445e38, 1, 0, {}})));
  EXPECT_TRUE(hole_at_7(imported({5, 5, with(0.1F), "Float32", {}, "", 0.1, 1, 0, {}})));
  EXPECT_TRUE(hole_at_7(
      imported({5, 5, with(3), "Float32", {}, "", {}, 1, 0, [](int c, int r) { return 5 * r + c != 7; }})));
  EXPECT_FALSE(hole_at_7(imported({5, 5, with(3), "Byte", {}, "", 200, 1, 0, {}})));
}

// A body of 1000 m: 1 deg is 17.45 m. East and north of (30 E, 0 N) a place at distance d is asin(d / R)
// away.
TEST_F(LoadDem, GeographicOnASmallSphere) {
  const std::array<double, 6> transform{25, 0.1, 0, 5, 0, -0.1};
  const std::string crs = "+proj=longlat +R=1000 +no_defs";
  TestRaster raster{101, 101, map_plane(transform), "Float64", transform, crs};
  DemBase dem = written(raster);
  dem.center = {30.0, 0.0};
  const GridSpec spec = GridSpec::centered(60, 5);
  const GeneratedTerrain terrain = terrain_of(dem, spec);
  for (const double d : {-60.0, -5.0, 0.0, 35.0, 60.0}) {
    const double degrees = std::asin(d / 1000) / kRadians;
    EXPECT_NEAR(terrain.nodes.at(spec.bin_of(d, 0)), 7 + 2 * (30 + degrees), 1e-9);
    EXPECT_NEAR(terrain.nodes.at(spec.bin_of(0, d)), 7 + 60 - 3 * degrees, 1e-9);
  }
  dem.center = {390.0, 0.0};  // the same place
  EXPECT_TRUE(std::ranges::equal(terrain_of(dem, spec).nodes.values(), terrain.nodes.values()));
  const MapPoint place = site_to_crs(terrain.crs_wkt, {50, 0}, crs);
  EXPECT_NEAR(place.x, 30 + std::asin(0.05) / kRadians, 1e-9);
  EXPECT_NEAR(place.y, 0, 1e-9);
}

// PROJ agrees with our own orthographic frame on an ellipsoid, through the WKT that goes into the file.
TEST_F(LoadDem, GeographicOnAnEllipsoidAgreesWithProj) {
  const std::array<double, 6> transform{137, 0.001, 0, -4, 0, -0.001};
  const std::string crs = "+proj=longlat +a=3396190 +b=3376200 +no_defs";
  const DemRaster raster = load_dem(written({1001, 1001, map_plane(transform), "Float32", transform, crs}),
                                    GridSpec::centered(20000, 100));
  for (const SitePoint p :
       {SitePoint{0, 0}, SitePoint{20000, 0}, SitePoint{-7000, 15000}, SitePoint{0, -20000}}) {
    const MapPoint by_proj = site_to_crs(raster.crs_wkt, p, crs);
    const MapPoint ours = GeoTransform(transform).map_point(raster.mapping.pixel(p));
    EXPECT_NEAR(ours.x, by_proj.x, 1e-9);  // 0.06 mm
    EXPECT_NEAR(ours.y, by_proj.y, 1e-9);
  }
}

TEST_F(LoadDem, PositionsOnTheMap) {
  const auto wkt = [&](const std::array<double, 6>& transform, const std::string& crs, const GridSpec& site) {
    return load_dem(written({41, 41, map_plane(transform), "Float64", transform, crs}), site).crs_wkt;
  };
  const auto at = [](const std::string& frame, double x_m, double y_m) {
    return map_positions(frame, {{0, 0}, {x_m, y_m}}).at(1);
  };
  const GridSpec small = GridSpec::centered(50, 5);
  // UTM has a false easting of its own, which the site's replaces.
  const MapPosition utm = at(wkt({500000, 10, 0, 4000000, 0, -10}, "EPSG:32631", small), 30.25, -40.5);
  EXPECT_EQ(utm.easting_m, 500205 + 30.25);
  EXPECT_EQ(utm.northing_m, 3999795 - 40.5);
  const MapPoint lon_lat =
      site_to_crs(wkt({500000, 10, 0, 4000000, 0, -10}, "EPSG:32631", small), {30.25, -40.5}, "EPSG:4326");
  EXPECT_NEAR(*utm.longitude_deg, lon_lat.x, 2e-9);
  EXPECT_NEAR(*utm.latitude_deg, lon_lat.y, 2e-9);
  // In metres, whatever the map's unit is.
  const MapPosition feet =
      at(wkt({6000000, 10, 0, 2000000, 0, -10}, "EPSG:2225", GridSpec::centered(40, 4)), 12, 0);
  EXPECT_NEAR(*feet.easting_m, 6000205 * 1200.0 / 3937 + 12, 1e-2);
  // A map whose scale at the site is not 1: x_m is not the difference of the eastings.
  const MapPosition plate = at(wkt({100000, 10, 0, 700000, 0, -10}, "+proj=eqc +R=1737400", small), 30, 0);
  const double stretch = 1 / std::cos((700000 - 205) / 1737400.0);
  EXPECT_NEAR(*plate.easting_m, 100205 + 30 * stretch, 1e-3);
  EXPECT_NEAR(*plate.northing_m, 699795, 1e-3);
  // A map of longitudes and latitudes has no easting.
  const MapPosition sphere =
      at(wkt({29, 0.05, 0, 1, 0, -0.05}, "+proj=longlat +R=1000 +no_defs", GridSpec::centered(10, 5)), 0, 0);
  EXPECT_EQ(sphere.easting_m, std::nullopt);
  EXPECT_NEAR(*sphere.longitude_deg, 30.025, 1e-9);
  EXPECT_NEAR(*sphere.latitude_deg, -0.025, 1e-9);
}

TEST_F(LoadDem, FrameOfTheMap) {
  const auto wkt = [&](const std::array<double, 6>& transform, const std::string& crs) {
    return load_dem(written({41, 41, map_plane(transform), "Float64", transform, crs}),
                    GridSpec::centered(40, 4))
        .crs_wkt;
  };
  const SitePoint point{12.345678, -30.0009765625};
  const auto utm = map_frame(wkt({500000.123, 10, 0, 5400000.789, 0, -10}, "EPSG:32631"));
  ASSERT_TRUE(utm);
  EXPECT_EQ(utm->crs_name, "WGS 84 / UTM zone 31N");
  EXPECT_TRUE(utm->crs_wkt.starts_with("PROJCS[\"WGS 84 / UTM zone 31N\"")) << utm->crs_wkt;
  EXPECT_EQ(utm->unit, "m");
  EXPECT_NEAR(utm->center.x, 500205.123, 2e-9);
  EXPECT_NEAR(utm->at(point).x, 500205.123 + point.x_m, 2e-9);
  EXPECT_NEAR(utm->at(point).y, 5399795.789 + point.y_m, 2e-9);
  const auto feet = map_frame(wkt({6000000, 10, 0, 2000000, 0, -10}, "EPSG:2225"));
  EXPECT_EQ(feet->unit, "ft");
  EXPECT_NEAR(feet->at(point).x, 6000205 + point.x_m * 3937 / 1200, 1e-8);
  // A map whose scale at the site is not 1, and longitudes and latitudes: the site frame is orthographic.
  const std::string cylindrical = "+proj=eqc +R=1737400";
  const std::string distorted = wkt({100000, 10, 0, 700000, 0, -10}, cylindrical);
  const auto plate = map_frame(distorted);
  const MapPoint by_proj = site_to_crs(distorted, point, cylindrical);
  EXPECT_NEAR(plate->at(point).x, by_proj.x, 1e-6);
  EXPECT_NEAR(plate->at(point).y, by_proj.y, 1e-6);
  EXPECT_NEAR(plate->center.x, 100205, 1e-8);
  const auto globe = map_frame(wkt({29, 1e-4, 0, 1, 0, -1e-4}, "EPSG:4326"));
  EXPECT_TRUE(globe->is_geographic);
  EXPECT_EQ(globe->unit, "degree");
  EXPECT_TRUE(globe->crs_wkt.starts_with("GEOGCS[\"WGS 84\"")) << globe->crs_wkt;
  EXPECT_NEAR(globe->center.x, 29.00205, 1e-12);
  EXPECT_NEAR(globe->center.y, 0.99795, 1e-12);
  // A site frame that names no map, that of an older file, is a map itself.
  const auto nameless = map_frame(without_place(wkt({500000, 10, 0, 5400000, 0, -10}, "EPSG:32631")));
  EXPECT_EQ(nameless->crs_name, "landfall site frame");
  EXPECT_EQ(nameless->at(point).x, point.x_m);
}

TEST(MapFrames, AFrameThatIsNotTiedToABodyHasNone) {
  EXPECT_FALSE(map_frame(kLocalSiteCrsWkt));
  EXPECT_FALSE(map_frame("PROJCRS[\"broken"));
}

TEST(MapPositions, AFrameThatIsNotTiedToABodyHasNone) {
  EXPECT_EQ(map_positions(kLocalSiteCrsWkt, {{1, 2}}), std::vector<MapPosition>(1));
  EXPECT_EQ(map_positions("", {{1, 2}}), std::vector<MapPosition>(1));
  EXPECT_EQ(map_positions("PROJCRS[\"broken", {{1, 2}}), std::vector<MapPosition>(1));
  EXPECT_EQ(no_map_positions(kLocalSiteCrsWkt), std::nullopt);
}

TEST_F(LoadDem, WithoutCrs) {
  const std::array<double, 6> transform{100, 2, 0, 50, 0, -2};
  const GridSpec spec = GridSpec::centered(30, 3);
  DemBase dem = written({21, 21, map_plane(transform), "Float64", transform});
  EXPECT_THAT(import_refusal(dem, spec), AllOf(HasSubstr("usage: "), HasSubstr("horizontal_scale_m")));
  dem.horizontal_scale_m = 3;  // metres per map unit, so 6 m per pixel
  const GeneratedTerrain terrain = terrain_of(dem, spec);
  expect_plane(terrain.nodes, 7 + 2 * 121 - 3 * 29, 2 / 3.0, -1);
  EXPECT_EQ(without_place(terrain.crs_wkt), kLocalSiteCrsWkt);
  EXPECT_EQ(place_of(terrain.crs_wkt)->metres_per_unit, 3);
  EXPECT_TRUE(is_local_in_metres(terrain.crs_wkt));
  dem.horizontal_scale_m = 0.0;
  EXPECT_THAT(import_refusal(dem, spec), HasSubstr("usage: "));
}

// Without georeference, x counts columns from the left edge, y rows from the bottom edge.
TEST_F(LoadDem, WithoutGeoreference) {
  DemBase dem = written({21, 11, [](int c, int r) { return 2 * c + 100 * r; }});
  dem.horizontal_scale_m = 4;
  const GridSpec spec = GridSpec::centered(8, 4);
  expect_plane(terrain_of(dem, spec).nodes, 20 + 500, 0.5, -25);
  dem.center = {2.5, 2.5};  // column 2, row 8
  expect_plane(terrain_of(dem, spec).nodes, 4 + 800, 0.5, -25);
}

TEST_F(LoadDem, RefusesWhatTheConfigGetsWrong) {
  const std::array<double, 6> transform{5e5, 1, 0, 0, 0, -1};
  const GridSpec spec = GridSpec::centered(4, 1);
  DemBase good = written({21, 21, map_plane(transform), "Float32", transform, "EPSG:32631"});
  EXPECT_EQ(import_refusal(good, spec), "accepted");
  DemBase dem = good;
  dem.horizontal_scale_m = 1;
  EXPECT_THAT(import_refusal(dem, spec), AllOf(HasSubstr("usage: "), HasSubstr("horizontal_scale_m"),
                                               HasSubstr("WGS 84 / UTM zone 31N")));
  dem = good;
  dem.band = 2;
  EXPECT_THAT(import_refusal(dem, spec), AllOf(HasSubstr("usage: "), HasSubstr("band 2 is not in 1..1")));
  dem = good;
  dem.center = {500010, -10};
  dem.center_pixel = {10, 10};
  EXPECT_THAT(import_refusal(dem, spec), AllOf(HasSubstr("usage: "), HasSubstr("not both")));
  dem.center.reset();
  dem.center_pixel = {3, 10};
  EXPECT_THAT(import_refusal(dem, spec),
              AllOf(HasSubstr("format: "), HasSubstr("21 x 21"), HasSubstr("half_width_m of 3 ")));
  dem = good;
  dem.center = {1000, 1000};
  EXPECT_THAT(import_refusal(dem, spec), HasSubstr("centre is outside"));
}

TEST_F(LoadDem, RefusesWhatTheFileCannotGive) {
  const std::array<double, 6> transform{0, 1, 0, 0, 0, -1};
  const GridSpec spec = GridSpec::centered(1, 1);
  const auto plane = map_plane(transform);
  DemBase dem;
  dem.path = (folder_ / "not there.tif").string();
  EXPECT_THAT(import_refusal(dem, spec), AllOf(HasSubstr("format: "), HasSubstr("no such file")));
  EXPECT_THAT(import_refusal(written({1, 21, plane, "Float32", transform, "EPSG:32631"}), spec),
              AllOf(HasSubstr("format: "), HasSubstr("1 x 21 pixels")));
  EXPECT_THAT(import_refusal(written({9, 9, plane, "CFloat32", transform, "EPSG:32631"}), spec),
              AllOf(HasSubstr("format: "), HasSubstr("complex")));
  EXPECT_THAT(import_refusal(written({9, 9, plane, "Float32", {}, "EPSG:32631"}), spec),
              AllOf(HasSubstr("format: "), HasSubstr("no geotransform")));
  EXPECT_THAT(import_refusal(written({9, 9, plane, "Float32", transform, "EPSG:4978"}), spec),
              AllOf(HasSubstr("format: "), HasSubstr("geocentric")));
  const std::array<double, 6> beyond{0, 0.001, 0, 95, 0, -0.001};
  EXPECT_THAT(import_refusal(written({9, 9, plane, "Float32", beyond, "EPSG:4326"}), spec),
              AllOf(HasSubstr("format: "), HasSubstr("beyond a pole")));
}

// No GeoTIFF's keys hold these CRS: the file beside it does.
TEST_F(LoadDem, RefusesCrsThatAreNoMap) {
  const std::array<double, 6> transform{0, 1, 0, 0, 0, -1};
  const DemBase dem = written({9, 9, map_plane(transform), "Float32", transform});
  const auto refusal_with = [&](const std::string& crs) {
    write_bytes(dem.path + ".aux.xml", "<PAMDataset><SRS>" + crs + "</SRS></PAMDataset>");
    return import_refusal(dem, GridSpec::centered(1, 1));
  };
  EXPECT_EQ(refusal_with("EPSG:32631"), "accepted");
  EXPECT_THAT(refusal_with("+proj=ob_tran +o_proj=longlat +o_lon_p=0 +o_lat_p=39.25 +lon_0=18 +R=6371229"),
              AllOf(HasSubstr("format: "), HasSubstr(dem.path), HasSubstr("rotated-pole")));
  EXPECT_THAT(refusal_with("LOCAL_CS[&quot;a sheet&quot;,UNIT[&quot;nothing&quot;,0]]"),
              AllOf(HasSubstr("format: "), HasSubstr(dem.path), HasSubstr("no linear unit")));
}

// Unknown cases of GDAL are told apart, because each calls for something else.
TEST_F(LoadDem, SaysWhatAFileThatIsNoRasterNeeds) {
  const GridSpec spec = GridSpec::centered(1, 1);
  const auto told = [&](const char* name, const std::string& bytes) {
    DemBase dem;
    dem.path = (folder_ / name).string();
    write_bytes(dem.path, bytes);
    return import_refusal(dem, spec);
  };
  EXPECT_THAT(told("raw.img", std::string(100, 7)),
              AllOf(HasSubstr("format: "), HasSubstr("VRTRawRasterBand")));
  EXPECT_THAT(told("cut.nc", "CDF\x01 and no more"), HasSubstr("begins as a netCDF file does"));
  EXPECT_THAT(told("cut.h5", "\x89HDF\r\n\x1a\n and no more"), HasSubstr("begins as a HDF5 file does"));
  EXPECT_THAT(told("rock.PLY", "ply\n"), HasSubstr("is a mesh by its extension"));
}

// Each header is read; none of the samples that it promises is.
TEST_F(LoadDem, RefusesBlocksBeyondAllMemory) {
  GDALRegister_GTiff();
  DemBase dem;
  dem.path = (folder_ / "blocks.tif").string();
  dem.horizontal_scale_m = 1;
  const char* const options[] = {"TILED=YES", "BLOCKXSIZE=65536", "BLOCKYSIZE=8192", "SPARSE_OK=TRUE",
                                 nullptr};
  GDALClose(GDALCreate(GDALGetDriverByName("GTiff"), dem.path.c_str(), 65536, 65536, 1, GDT_Byte,
                       const_cast<char**>(options)));
  EXPECT_THAT(import_refusal(dem, GridSpec::centered(1, 1)),
              AllOf(HasSubstr("format: "), HasSubstr("blocks of 512 MiB")));
}

// A cell of 121 columns that calls itself complete, cut after 100 of them: 100 still open and read well.
TEST_F(LoadDem, RefusesATruncatedDtedCell) {
  const double post = 1.0 / 120;
  const std::array<double, 6> cell{9.0 - post / 2, post, 0, 44.0 + post / 2, 0, -post};
  const DemBase source = written({121, 121, [](int c, int r) { return c + r; }, "Int16", cell, "EPSG:4326"});
  GDALRegister_DTED();
  GDALDatasetH const raster = GDALOpen(source.path.c_str(), GA_ReadOnly);
  DemBase dem = source;
  dem.path = (folder_ / "n43.dt0").string();
  GDALClose(
      GDALCreateCopy(GDALGetDriverByName("DTED"), dem.path.c_str(), raster, 0, nullptr, nullptr, nullptr));
  GDALClose(raster);
  dem.center = {9.2, 43.5};
  const GridSpec spec = GridSpec::centered(2000, 500);
  EXPECT_EQ(import_refusal(dem, spec), "accepted");
  std::filesystem::resize_file(dem.path, 3428 + 100 * (12 + 2 * 121));
  EXPECT_THAT(import_refusal(dem, spec), AllOf(HasSubstr("format: "), HasSubstr("100 of the 121 columns")));
}

// The shorter edge of a cell; of one in degrees the longer, whatever the latitude.
TEST_F(LoadDem, TellsThePostingOfItsPixels) {
  const auto posting = [&](const std::array<double, 6>& transform, const char* crs) {
    const DemBase dem = written({21, 21, map_plane(transform), "Float32", transform, crs});
    return fit_dem_site(dem, {}).resolution_m;
  };
  EXPECT_EQ(posting({5e5, 0.3, 0, 0, 0, -0.3}, "EPSG:32631"), 0.3);
  EXPECT_EQ(posting({5e5, 5, 0, 0, 0, -7}, "EPSG:32631"), 5);
  EXPECT_EQ(posting({5e5, 3, -4, 0, 4, 3}, "EPSG:32631"), 5);  // turned by 53 degrees
  EXPECT_DOUBLE_EQ(posting({0, 1, 0, 80, 0, -1}, "+proj=longlat +R=180000"), 1000 * std::numbers::pi);
}

// 8200 x 8200 exceed 64 Mpx: only a window is read (1 MB here, not 538 MB), and it says the same.
TEST_F(LoadDem, LargeRastersAreReadByWindow) {
  const std::array<double, 6> transform{5e5, 1, 0, 0, 0, -1};
  const auto plane = [](int col, int row) { return 2 * col + 3 * row; };
  DemBase dem = written({8200, 8200, plane, "Int32", transform, "EPSG:32631"});
  dem.interpolation = Interpolation::bicubic;
  dem.center_pixel = {8000, 3000};
  const GridSpec spec = GridSpec::centered(150, 2);
  const DemRaster raster = load_dem(dem, spec);
  EXPECT_EQ(raster.source.size, (RasterSize{8200, 8200}));
  EXPECT_LE(raster.samples.size.cols, 308);
  EXPECT_LE(raster.samples.size.rows, 308);
  expect_plane(terrain_of(dem, spec).nodes, 2 * 8000 + 3 * 3000, 2, -3);
}

}  // namespace
}  // namespace landfall
