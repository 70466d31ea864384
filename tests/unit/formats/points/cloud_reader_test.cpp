// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/core/error.h"
#include "cloud_files.h"
#include "formats/points/cloud_fields.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::size_t column_of(CloudField field, const std::vector<std::string>& names,
                      const std::string& choice = "") {
  return cloud_columns(names, column_choice(choice), "f").columns.at(static_cast<std::size_t>(field)).value();
}

ColumnUnit unit_of(CloudField field, const std::vector<std::string>& names, const std::string& choice = "") {
  return cloud_columns(names, column_choice(choice), "f").units.at(static_cast<std::size_t>(field));
}

TEST(CloudFields, AreFoundByTheirUsualNames) {
  for (const std::string name : {"x", "X", "E", "Easting [m]", "x_est_m", "Scalar_X"})
    EXPECT_EQ(column_of(CloudField::x, {"n", "z", name}), 2U) << name;
  for (const std::string name : {"lon", "longitude_deg", "LONGITUDE_CENTROID", "GLON", "lng"})
    EXPECT_EQ(column_of(CloudField::x, {"lat", "z", name}), 2U) << name;
  for (const std::string name : {"z", "u", "Up", "H", "ELEVATION_LOW", "elev"})
    EXPECT_EQ(column_of(CloudField::z, {"e", "n", name}), 2U) << name;
  for (const std::string name : {"gps_time", "GpsTime", "t_s", "Timestamp"})
    EXPECT_EQ(column_of(CloudField::t, {"x", "y", "z", name}), 3U) << name;
}

TEST(CloudFields, TheBestNameWins) { EXPECT_EQ(column_of(CloudField::x, {"x", "x_est", "y", "z"}), 1U); }

TEST(CloudFields, AreChosenByNameOrNumber) {
  EXPECT_EQ(column_of(CloudField::x, {"a", "b", "c"}, "x=c,y=2,z=1"), 2U);
  EXPECT_EQ(column_of(CloudField::x, {"3", "b", "c"}, "x=3,y=2,z=1"), 0U);  // a name before a number
}

TEST(CloudFields, RefuseAWrongChoice) {
  const auto refused = [](const std::string& choice) {
    return refusal([&] { return column_of(CloudField::x, {"x", "y", "z", "u", "u"}, choice); });
  };
  EXPECT_THAT(refused("x"), HasSubstr("is not FIELD=COLUMN"));
  EXPECT_THAT(refused("x="), HasSubstr("is not FIELD=COLUMN"));
  EXPECT_THAT(refused("q=1"), HasSubstr("is not one of x, y, z"));
  EXPECT_THAT(refused("x=1,x=2"), HasSubstr("gives x twice"));
  EXPECT_THAT(refused("x=9"), HasSubstr("has no such column; it has x, y, z"));
  EXPECT_THAT(refused("x=0"), HasSubstr("has no such column"));
  EXPECT_THAT(refused("x=u"), HasSubstr("has that column twice"));
}

TEST(CloudFields, RefuseToLeaveThePositionOut) {
  EXPECT_THAT(refusal([] { return column_choice("z=-"); }), HasSubstr("a point has x, y and z"));
  const CloudTable table = cloud_columns({"x", "y", "z", "t", "pulse"}, column_choice("t=-"), "f");
  EXPECT_FALSE(table.columns[static_cast<std::size_t>(CloudField::t)]);
  EXPECT_TRUE(table.columns[static_cast<std::size_t>(CloudField::pulse)]);
}

TEST(CloudFields, LongitudeLowIsTheGroundOfLvis) {
  const std::vector<std::string> names = {"LONGITUDE_CENTROID", "LATITUDE_CENTROID", "ELEVATION_CENTROID",
                                          "LONGITUDE_LOW",      "LATITUDE_LOW",      "ELEVATION_LOW"};
  const CloudTable table = cloud_columns(names, {}, "f");
  EXPECT_EQ(table.columns[0], 3U);
  EXPECT_EQ(table.columns[1], 4U);
  EXPECT_EQ(table.columns[2], 5U);
  ASSERT_EQ(table.notes.size(), 1U);
  EXPECT_THAT(table.notes[0], HasSubstr("ELEVATION_LOW"));
}

TEST(CloudFields, TheNameStatesTheUnit) {
  struct Case {
    const char* name;
    double metres;
  };
  for (const Case& known :
       {Case{"x [mm]", 1e-3}, Case{"X (km)", 1e3}, Case{"E{ft}", 0.3048}, Case{"x_mm", 1e-3},
        Case{"x/cm", 1e-2}, Case{"x in mm", 1e-3}, Case{"x..mm.", 1e-3},
        Case{"Easting (US survey ft)", 1200. / 3937}, Case{"x_us_ft", 1200. / 3937},
        Case{"x (UTM) [km]", 1e3}, Case{"Points_mm_XYZ:0", 1e-3}, Case{"Points_m_XYZ:0", 1},
        Case{"x <inch>", 0.0254}, Case{"x (1e3 m)", 1e3}, Case{"x [\xc2\xb5m]", 1e-6}}) {
    const ColumnUnit unit = unit_of(CloudField::x, {known.name, "y [m]", "z"});
    EXPECT_EQ(unit.kind, ColumnUnit::Kind::length) << known.name;
    EXPECT_NEAR(unit.factor / known.metres, 1, 1e-12) << known.name;
  }
  EXPECT_EQ(unit_of(CloudField::x, {"Points:0", "Points:1", "Points:2"}).kind, ColumnUnit::Kind::unstated);
  EXPECT_EQ(unit_of(CloudField::z, {"x", "y", "z [m below sea level]"}).factor, -1);
  EXPECT_EQ(unit_of(CloudField::z, {"x", "y", "Elevation (ft NAVD88)"}).factor, 0.3048);
  for (const std::string name : {"t_ms", "t [ms]", "GPS time (msec)", "time/ms"})
    EXPECT_NEAR(unit_of(CloudField::t, {"x", "y", "z", name}).factor, 1e-3, 1e-15) << name;
  EXPECT_EQ(unit_of(CloudField::intensity, {"x", "y", "z", "intensity [counts]"}).kind,
            ColumnUnit::Kind::unstated);
}

TEST(CloudFields, LongitudesAndLatitudesAreInDegrees) {
  for (const auto& names :
       std::vector<std::vector<std::string>>{{"lon", "lat", "z"},
                                             {"longitude_deg", "latitude_deg", "z"},
                                             {"x [deg]", "y [deg]", "z"},
                                             {"x [degrees_east]", "y [degrees_north]", "z"},
                                             {"x (\xc2\xb0)", "y (\xc2\xb0)", "z"}}) {
    const ColumnUnit unit = unit_of(CloudField::x, names);
    EXPECT_EQ(unit.kind, ColumnUnit::Kind::angle) << names[0];
    EXPECT_EQ(unit.factor, 1) << names[0];
  }
  EXPECT_EQ(unit_of(CloudField::x, {"a", "b", "LONGITUDE_HIGH", "LATITUDE_HIGH"}, "x=3,y=4,z=1").kind,
            ColumnUnit::Kind::angle);
  EXPECT_NEAR(unit_of(CloudField::x, {"lon [rad]", "lat [rad]", "z"}).factor, 57.29577951308232, 1e-12);
}

TEST(CloudFields, RefuseUnitsThatAreNotTheirs) {
  const auto refused = [](const std::vector<std::string>& names) -> std::string {
    return refusal<FormatError>([&] { return cloud_columns(names, {}, "f"); });
  };
  EXPECT_THAT(refused({"x [furlungs]", "y", "z"}), HasSubstr("'furlungs' in the name of its column"));
  EXPECT_THAT(refused({"x [s]", "y [s]", "z"}), HasSubstr("is not a unit of length"));
  EXPECT_THAT(refused({"lon [m]", "lat [m]", "z"}), HasSubstr("is not a unit of length"));
  EXPECT_THAT(refused({"lon (degrees_west)", "lat", "z"}), HasSubstr("is not a unit of length"));
  EXPECT_THAT(refused({"x", "y", "z (deg)"}), HasSubstr("--columns z=3 takes it in metres"));
  EXPECT_THAT(refused({"x", "y", "z", "t [m]"}), HasSubstr("t=- leaves it out"));
  EXPECT_THAT(refused({"x [mm]", "y", "z"}), HasSubstr("x ('x [mm]') has mm and y ('y') has no unit"));
  EXPECT_THAT(refused({"lon", "N", "z"}), HasSubstr("has degrees and y ('N') has no unit"));
  EXPECT_THAT(refused({"x_point", "y", "z"}), HasSubstr("no column is recognised as x"));
  EXPECT_EQ(unit_of(CloudField::x, {"x [mm]", "y [km]", "z"}).factor, 1e-3);  // each by its own
}

TEST(CloudFields, AChosenColumnWithAStrangeUnitIsTakenWithANote) {
  const CloudTable table = cloud_columns({"x (grid)", "y", "z"}, column_choice("x=1"), "f");
  EXPECT_EQ(table.units[0].kind, ColumnUnit::Kind::unstated);
  ASSERT_EQ(table.notes.size(), 1U);
  EXPECT_THAT(table.notes[0], HasSubstr("metres are assumed"));
}

bool is_cloud(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return is_cloud_file(folder / name);
}

const std::string kGrid = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n4 5 6\n";

TEST(CloudReader, TheContentDecidesWhatIsACloud) {
  for (const std::string name : {"a.asc", "a", "a.tif", "a.xyz"}) {
    SCOPED_TRACE(name);
    EXPECT_TRUE(is_cloud(name, "//X Y Z Intensity\n-9.9 -9.8 -1 5\n1 2 3 4\n"));
    EXPECT_TRUE(is_cloud(name, "1 2 3\n4 5 6\n"));
    EXPECT_TRUE(is_cloud(name, "x,y,z\n1,2,3\n"));
    EXPECT_TRUE(is_cloud(name, "ply \r\nformat ascii 1.0\n"));
    EXPECT_TRUE(is_cloud(name, "# a comment\nVERSION .7\nFIELDS x y z\n"));
    EXPECT_TRUE(
        is_cloud(name, "2\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n"));
  }
  for (const std::string name : {"a.asc", "a", "a.txt", "a.xyz", "a.dat", "a.grd"}) {
    SCOPED_TRACE(name);
    EXPECT_FALSE(is_cloud(name, kGrid));
    EXPECT_FALSE(is_cloud(name, "NCOLS 3\r\nNROWS 2\r\n"));
    EXPECT_FALSE(is_cloud(name, "DSAA\n3 2\n0 2\n0 1\n1 6\n1 2 3\n4 5 6\n"));
    EXPECT_FALSE(is_cloud(name, "north: 2\nsouth: 0\neast: 3\nwest: 0\nrows: 2\ncols: 3\n1 2 3\n4 5 6\n"));
    EXPECT_FALSE(is_cloud(name, std::string("II*\0\x08\0\0\0", 8)));
    EXPECT_FALSE(is_cloud(name, std::string("\0\0\0\1\0\2\0\3", 8)));
  }
  EXPECT_FALSE(is_cloud("a.vrt", "<VRTDataset rasterXSize=\"2\">\n"));
  EXPECT_FALSE(is_cloud("a.vrt", "<VRTDataset><GeoTransform>0, 1, 0, 13, 0, -1</GeoTransform></VRTDataset>"));
  EXPECT_FALSE(is_cloud("a.json", "{\"a\": 1, \"b\": [1, 2, 3, 4]}\n"));
  EXPECT_FALSE(is_cloud("a.hdr", "ENVI\nsamples = 3\nlines = 2\n"));
  EXPECT_FALSE(is_cloud("a.lbl", "PDS_VERSION_ID = PDS3\nRECORD_TYPE = FIXED_LENGTH\n"));
  EXPECT_FALSE(is_cloud("a.asc", "1 2\n3 4\n"));
  EXPECT_TRUE(is_cloud("a.csv", ""));              // refused as empty, not as a raster
  EXPECT_TRUE(is_cloud("a.csv", "\x1F\x8B\x08"));  // refused as compressed
  EXPECT_TRUE(is_cloud_file("/no/such/file.csv"));
  EXPECT_FALSE(is_cloud_file("/no/such/file.tif"));
}

TEST(CloudReader, ReadsAPlyAndAPcdWhoseFirstLineDiffers) {
  const std::string ply =
      "ply \nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n1 2 3\n";
  EXPECT_THAT(read_cloud("a", ply)[CloudField::z], ElementsAre(3));
  const std::string pcd =
      "# made by hand\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3\n";
  EXPECT_THAT(read_cloud("a", pcd)[CloudField::z], ElementsAre(3));
}

TEST(CloudReader, SaysThatCommasDoNotDivideValuesOfPcdAndPly) {
  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1,2,3\n";
  EXPECT_THAT(cloud_refusal("a.pcd", pcd), HasSubstr("line 8: '1,2,3' is not a number: blanks must divide"));
}

TEST(CloudReader, NamesOfPlyAndPcdStateUnitsToo) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float lon\nproperty float lat\nproperty float "
      "z_ft\nend_header\n1 2 3\n";
  const CloudInfo info = read_cloud("a.ply", ply).info;
  EXPECT_EQ(info.units[0].kind, ColumnUnit::Kind::angle);
  EXPECT_EQ(info.units[2].factor, 0.3048);
}

}  // namespace
}  // namespace landfall
