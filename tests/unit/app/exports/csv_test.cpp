// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/exports/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/core/error.h"
#include "memory_sink.h"
#include "refusal.h"
#include "small_scan.h"
#include "temporary_folder.h"
#include "test_maps.h"

namespace landfall {
namespace {

std::string csv(const SmallScan& scan, const PointReader::Pass& pass) {
  const TemporaryFolder folder;
  scan.write(folder / "scan.h5");
  MemorySink sink;
  write_points_csv(PointReader(folder / "scan.h5"), pass, sink);
  return sink.bytes();
}

std::string failure(const SmallScan& scan, const PointReader::Pass& pass) {
  return refusal<FormatError>([&] { return csv(scan, pass); });
}

TEST(PointsCsv, HoldsTheReturnsWithUnitsInTheHeadings) {
  EXPECT_EQ(csv({}, {{"x_est", "t", "pulse", "status"}, {true, 1}}),
            "x_est_m,t_s,pulse,status\n1,0,0,0\n2,0.25,1,0\n2.5,0.25,1,6\n3,0.5,2,0\n");
}

TEST(PointsCsv, KeepsEveryRowWhereAskedTo) {
  EXPECT_EQ(csv({}, {{"z_est", "status"}, {false, 1}}), "z_est_m,status\n2,0\nnan,1\n4,0\n5,6\n6,0\n");
}

TEST(PointsCsv, TakesEveryNthOfTheReturns) {
  EXPECT_EQ(csv({}, {{"x_true"}, {true, 2}}), "x_true_m\n101\n102.5\n");
  EXPECT_EQ(csv({}, {{"x_true"}, {true, 3}}), "x_true_m\n101\n103\n");
}

TEST(PointsCsv, NamesTheRowOfAPulseThatIsNotThere) {
  SmallScan scan;
  scan.pulse[3] = 3;
  EXPECT_THAT(failure(scan, {{"t"}, {true, 1}}),
              testing::EndsWith("/points/pulse[3] is 3, which /pulses does not have"));
}

TEST(PointsCsv, NamesTheRowOfAReturnWithoutAPlace) {
  SmallScan scan;
  scan.x[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(failure(scan, {{"x_est"}, {true, 1}, 1}),
              testing::EndsWith("/points/x_est[4] of a return is not finite"));
}

TEST(PointReader, CountsWhatIsSelected) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  const PointReader points(folder / "scan.h5");
  EXPECT_EQ(points.count({true, 1}), 4U);
  EXPECT_EQ(points.count({true, 3}), 2U);
  EXPECT_EQ(points.count({false, 1}), 5U);
  EXPECT_EQ(points.count({false, 2}), 3U);
  EXPECT_THAT(refusal([&] { return points.column("q"); }),
              testing::EndsWith("no column 'q'; it has x_est, y_est, z_est, x_true, y_true, z_true, pulse, "
                                "status, t"));
}

/// As landfall-import writes it: estimated positions alone.
void write_imported(const std::filesystem::path& path) {
  LandfallFileWriter file({path, true, 1}, "scan", {.tool = "landfall-import", .config = {{"a", 1}}});
  const std::vector<double> x = {1, 2, 3};
  const std::span<const double> rows(x);
  write_table(file.root(), "points",
              {{"x_est", h5::Type::float64, "m", "x"},
               {"y_est", h5::Type::float64, "m", "y"},
               {"z_est", h5::Type::float64, "m", "z"}},
              std::array<ColumnRows, 3>{rows, rows, rows}, 1);
  file.commit();
}

TEST(PointReader, ReadsAnImportedScan) {
  const TemporaryFolder folder;
  write_imported(folder / "scan.h5");
  const PointReader points(folder / "scan.h5");
  EXPECT_TRUE(points.has("z_est"));
  EXPECT_FALSE(points.has("x_true"));
  EXPECT_EQ(points.count({true, 1}), 3U);
  MemorySink sink;
  write_points_csv(points, {position_columns("est"), {true, 2}, 3}, sink);
  EXPECT_EQ(sink.bytes(), "x_est_m,y_est_m,z_est_m\n1,1,1\n3,3,3\n");
  EXPECT_EQ(refusal([&] { return points.column("x_true"); }),
            (folder / "scan.h5").string() + ": no column 'x_true'; it has x_est, y_est, z_est");
}

TEST(LayersCsv, TellsBinsFromTheSouthRowByRow) {
  const GridSpec spec{0.5, -1, 0, 2, 3};
  Grid<float> z(spec, 0.1F);
  z.at({0, 1}) = std::numeric_limits<float>::quiet_NaN();
  Grid<std::int8_t> flag(spec, 1);
  flag.at({1, 2}) = -3;
  const std::vector<NamedLayer> layers = {{{"z", h5::Type::float32, "m", ""}, z},
                                          {{"flag", h5::Type::int8, "1", ""}, flag}};
  MemorySink all;
  write_layers_csv(layers, 1, all);
  EXPECT_EQ(
      all.bytes(),
      "x_m,y_m,z_m,flag\n0,-0.5,0.1,1\n0.5,-0.5,nan,1\n1,-0.5,0.1,1\n0,0,0.1,1\n0.5,0,0.1,1\n1,0,0.1,-3\n");
  MemorySink some;
  write_layers_csv(layers, 4, some);
  EXPECT_EQ(some.bytes(), "x_m,y_m,z_m,flag\n0,-0.5,0.1,1\n0.5,0,0.1,1\n");
}

TEST(NameWithUnit, EndsWithTheUnitOnce) {
  EXPECT_EQ(name_with_unit({"range", h5::Type::float64, "m", ""}), "range_m");
  EXPECT_EQ(name_with_unit({"range_m", h5::Type::float64, "m", ""}), "range_m");
  EXPECT_EQ(name_with_unit({"count", h5::Type::int32, "1", ""}), "count");
  EXPECT_EQ(name_with_unit({"v", h5::Type::float64, "m s-1", ""}), "v");
}

std::string csv_on(const MapFrame& map, const std::vector<std::string>& columns) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  PointReader points(folder / "scan.h5");
  points.place_on(map);
  MemorySink sink;
  write_points_csv(points, {columns, {true, 2}}, sink);
  return sink.bytes();
}

TEST(PointsCsv, OnAMapNamesItsCoordinates) {
  EXPECT_EQ(csv_on(planar_map(), {"x_est", "y_est", "z_est", "x_true", "status"}),
            "easting_ft,northing_ft,elevation_m,easting_true_ft,status\n"
            "500002,5399998.5,302,500202,0\n500005,5399995.5,305,500205,6\n");
  EXPECT_EQ(csv_on(geographic_map(), {"y_est", "x_est", "t"}),
            "latitude_deg,longitude_deg,t_s\n47.99998,9.00001,0\n47.99995,9.000025,0.25\n");
}

TEST(PointsCsv, OnAMapACoordinateMayNeedBothOfTheSite) {
  EXPECT_EQ(csv_on(planar_map(), {"y_est"}), "northing_ft\n5399998.5\n5399995.5\n");
  EXPECT_THAT(refusal([] { return csv_on(geographic_map(), {"y_est"}); }),
              testing::HasSubstr("name x_est and y_est, or give --frame site"));
}

TEST(PointReader, NamesAPointThatTheMapCannotHold) {
  MapFrame map = geographic_map();
  map.map_point = [](const SitePoint&) { return MapPoint{std::numeric_limits<double>::quiet_NaN(), 0}; };
  EXPECT_THAT(refusal<FormatError>([&] {
                return csv_on(map, {"x_est", "y_est"});
              }),
              testing::HasSubstr("/points/x_est[0] of a point lies outside its map projection"));
}

}  // namespace
}  // namespace landfall
