// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/exports/point_clouds.h"
#include "app/exports/point_thinning.h"
#include "app/exports/xdmf.h"
#include "base/numerics/random.h"
#include "memory_sink.h"
#include "small_scan.h"
#include "temporary_folder.h"
#include "test_maps.h"

namespace landfall {
namespace {

using testing::HasSubstr;

constexpr const char* kFields =
    "VERSION 0.7\nFIELDS x y z scalar_x_est scalar_pulse scalar_status\nSIZE 4 4 4 8 4 1\nTYPE F F F F I I\n"
    "COUNT 1 1 1 1 1 1\nWIDTH 4\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA binary\n";

TEST(PointsPcd, HasSinglePlacesAndStoredTypes) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  MemorySink sink;
  const double rounding_m =
      write_points_pcd(PointReader(folder / "scan.h5"),
                       {{"x_true", "y_true", "z_true", "x_est", "pulse", "status"}, {true, 1}, 3}, sink);
  EXPECT_EQ(rounding_m, 0);
  EXPECT_THAT(sink.bytes(), testing::StartsWith("# .PCD v0.7 - Point Cloud Data file format\n# "));
  const std::size_t header = sink.bytes().find(kFields);
  ASSERT_NE(header, std::string::npos);
  const std::string data = sink.bytes().substr(header + std::string(kFields).size());
  ASSERT_EQ(data.size(), 4U * 25U);
  EXPECT_EQ(at<float>(data, 2 * 25), 102.5F);
  EXPECT_EQ(at<float>(data, 2 * 25 + 4), -2.5F);
  EXPECT_EQ(at<float>(data, 2 * 25 + 8), 5);
  EXPECT_EQ(at<double>(data, 2 * 25 + 12), 2.5);
  EXPECT_EQ(at<std::int32_t>(data, 2 * 25 + 20), 1);
  EXPECT_EQ(at<std::int8_t>(data, 2 * 25 + 24), 6);
}

TEST(PointsPcd, TellsTheLargestRounding) {
  const TemporaryFolder folder;
  SmallScan scan;
  scan.x[2] = 100000.003;  // float32 has steps of 1/128 m there, and of 1/64 m at twice as much
  scan.write(folder / "scan.h5");
  MemorySink sink;
  const double rounding_m =
      write_points_pcd(PointReader(folder / "scan.h5"), {{"x_est", "y_est", "z_est"}, {true, 1}, 3}, sink);
  EXPECT_NEAR(rounding_m, 0.006, 1e-9);
}

TEST(PointsPcd, OnAMapIsRelativeToItsViewpoint) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  PointReader points(folder / "scan.h5");
  points.place_on(planar_map());
  MemorySink sink;
  EXPECT_EQ(write_points_pcd(points, {{"x_est", "y_est", "z_est", "x_true"}, {true, 1}, 3}, sink), 0);
  const std::string header_end = "VIEWPOINT 500000 5400000.5 300 1 0 0 0\nPOINTS 4\nDATA binary\n";
  const std::size_t header = sink.bytes().find(header_end);
  ASSERT_NE(header, std::string::npos) << sink.bytes();
  EXPECT_THAT(sink.bytes(), HasSubstr("# crs PROJCS[\"map\"]\n"));
  const std::string data = sink.bytes().substr(header + header_end.size());
  EXPECT_EQ(at<float>(data, 0), 2);
  EXPECT_EQ(at<float>(data, 4), -2);
  EXPECT_EQ(at<float>(data, 8), 2);
  EXPECT_EQ(at<double>(data, 12), 500202);
}

TEST(PointsPly, HasDoublePlacesAndStoredTypes) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  MemorySink sink;
  write_points_ply(PointReader(folder / "scan.h5"),
                   {{"x_true", "y_true", "z_true", "x_est", "pulse", "status"}, {true, 1}, 3}, sink);
  const std::string properties =
      "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
      "property double scalar_x_est\nproperty int scalar_pulse\nproperty char scalar_status\nend_header\n";
  const std::size_t header = sink.bytes().find(properties);
  ASSERT_NE(header, std::string::npos);
  EXPECT_THAT(sink.bytes(), testing::StartsWith("ply\nformat binary_little_endian 1.0\ncomment "));
  const std::string data = sink.bytes().substr(header + properties.size());
  ASSERT_EQ(data.size(), 4U * 37U);
  EXPECT_EQ(at<double>(data, 2 * 37), 102.5);
  EXPECT_EQ(at<double>(data, 2 * 37 + 8), -2.5);
  EXPECT_EQ(at<double>(data, 2 * 37 + 16), 5);
  EXPECT_EQ(at<double>(data, 2 * 37 + 24), 2.5);
  EXPECT_EQ(at<std::int32_t>(data, 2 * 37 + 32), 1);
  EXPECT_EQ(at<std::int8_t>(data, 2 * 37 + 36), 6);
}

TEST(PointsPly, OnAMapHasItsCoordinatesAndCrs) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  PointReader points(folder / "scan.h5");
  points.place_on(planar_map());
  MemorySink sink;
  write_points_ply(points, {{"x_est", "y_est", "z_est"}, {true, 1}, 3}, sink);
  EXPECT_THAT(sink.bytes(), HasSubstr("comment landfall points: coordinates in map, z up, unit m\n"
                                      "comment crs PROJCS[\"map\"]\n"));
  EXPECT_THAT(sink.bytes(), HasSubstr("comment x: easting, easting, estimated position in map, unit ft\n"));
  const std::string data = sink.bytes().substr(sink.bytes().find("end_header\n") + 11);
  EXPECT_EQ(at<double>(data, 0), 500002);
  EXPECT_EQ(at<double>(data, 8), 5399998.5);
  EXPECT_EQ(at<double>(data, 16), 302);
}

std::vector<PointPlace> random_places(std::size_t count, std::uint64_t seed) {
  const RandomField random(seed, RandomStream::range_noise);
  std::vector<double> draws(2 * count);
  random.normals_along_i(0, 0, draws);
  std::vector<PointPlace> places;
  for (std::size_t i = 0; i < count; ++i) places.push_back({10 * draws[2 * i], 10 * draws[2 * i + 1]});
  return places;
}

constexpr PointPlace kLow = {-80, -80};
constexpr PointPlace kHigh = {80, 80};

ThinnedPoints thinned(const std::vector<PointPlace>& places, std::size_t maximum, double cell_m = 0.01) {
  PointThinning thinning(kLow, kHigh, cell_m, maximum);
  for (std::size_t i = 0; i < places.size(); ++i) thinning.add(places[i], 2 * i);
  return thinning.finish();
}

TEST(PointThinning, KeepsAllOfFewPoints) {
  const ThinnedPoints all = thinned({{0, 0}, {0, 0}, {1, 2}}, 3);
  EXPECT_THAT(all.rows, testing::ElementsAre(0, 2, 4));
  EXPECT_EQ(all.cell_m, 0);
}

TEST(PointThinning, KeepsOnePointOfEachSquare) {
  const std::vector<PointPlace> places = random_places(60000, 1);
  const ThinnedPoints some = thinned(places, 3000);
  EXPECT_LE(some.rows.size(), 3000U);
  EXPECT_GT(some.rows.size(), 2500U);
  ASSERT_GT(some.cell_m, 0);
  std::map<std::array<int, 2>, int> cells;
  for (const std::uint64_t row : some.rows) {
    std::array<int, 2> cell{};
    for (std::size_t axis = 0; axis < 2; ++axis)
      cell[axis] = static_cast<int>(std::floor((places[row / 2][axis] - kLow[axis]) / some.cell_m));
    ++cells[cell];
  }
  // rounding to 2^-32 of the extent may move a point on an edge to the next square
  EXPECT_GE(cells.size() + 2, some.rows.size());
  EXPECT_TRUE(std::ranges::is_sorted(some.rows));
}

TEST(PointThinning, KeepsLonelyPointsAmongMany) {
  std::vector<PointPlace> places = random_places(60000, 2);
  places.insert(places.begin() + 30000, {70, -70});
  const ThinnedPoints some = thinned(places, 1000);
  EXPECT_THAT(some.rows, testing::Contains(60000));
}

TEST(PointThinning, ChoosesAtRandomInASquare) {
  // 30 points in each square of a regular grid; the mean number of the chosen ones is 14.5 +- 0.07
  std::vector<PointPlace> places;
  for (int square = 0; square < 16384; ++square)
    for (int i = 0; i < 30; ++i)
      places.push_back({-79.5 + 1.25 * (square % 128), -79.5 + 1.25 * (square / 128)});
  const ThinnedPoints some = thinned(places, 16384);
  ASSERT_EQ(some.rows.size(), 16384U);
  double sum = 0;
  for (const std::uint64_t row : some.rows) sum += static_cast<double>(row / 2 % 30);
  EXPECT_NEAR(sum / 16384, 14.5, 0.28);
}

TEST(PointThinning, TheFirstSquaresMayBeTooSmall) {
  const std::vector<PointPlace> places = random_places(30000, 3);
  const ThinnedPoints some = thinned(places, 500, 1e-9);
  EXPECT_LE(some.rows.size(), 500U);
  EXPECT_GT(some.rows.size(), 400U);
}

TEST(PointThinning, PointsAtOnePlace) {
  PointThinning thinning({5, 5}, {5, 5}, 1, 10);
  for (std::uint64_t row = 0; row < 100; ++row) thinning.add({5, 5}, row);
  EXPECT_THAT(thinning.finish().rows, testing::SizeIs(1));
}

TEST(Xdmf, NamesDataInOrBelowItsFolderRelatively) {
  EXPECT_EQ(xdmf_reference("/tmp/a/scan.h5", "/tmp/a/scan.xmf"), "scan.h5");
  EXPECT_EQ(xdmf_reference("/tmp/a/b/scan.h5", "/tmp/a/scan.xmf"), "b/scan.h5");
  EXPECT_EQ(xdmf_reference("/tmp/b/scan.h5", "/tmp/a/scan.xmf"), "/tmp/b/scan.h5");
  EXPECT_EQ(xdmf_reference("scan.h5", "other.xmf"), "scan.h5");
}

TEST(Xdmf, NamesDataFromTheFolderOfALinkThatItReplaces) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "other");
  std::filesystem::create_symlink(folder / "other/old.xmf", folder / "scan.xmf");
  EXPECT_EQ(xdmf_reference(folder / "scan.h5", folder / "scan.xmf"), "scan.h5");
}

TEST(Xdmf, PlacesPointsByOneDatasetAndNamesThem) {
  const std::vector<ContentInfo> columns = {{"x_est", h5::Type::float32, "m", ""},
                                            {"status", h5::Type::int8, "1", ""}};
  const PointPositions positions{"a&b.h5", {"x_est", "y_est", "z_est"}, h5::Type::float32, 7, ""};
  EXPECT_EQ(xdmf_positions("c/p.xmf"), "c/p.xmf.h5");
  const std::string text = points_xdmf(columns, positions, "p.xmf.h5");
  EXPECT_THAT(text, HasSubstr(R"(TopologyType="Polyvertex" NumberOfElements="7")"));
  EXPECT_THAT(text,
              HasSubstr(R"(Dimensions="7 1" NumberType="Int" Precision="4" Format="HDF">p.xmf.h5:/row<)"));
  EXPECT_THAT(
      text,
      HasSubstr(R"(Dimensions="7 3" NumberType="Float" Precision="4" Format="HDF">p.xmf.h5:/position<)"));
  EXPECT_THAT(
      text,
      HasSubstr(R"(Dimensions="7" NumberType="Float" Precision="4" Format="HDF">a&amp;b.h5:/points/x_est<)"));
  EXPECT_THAT(text, HasSubstr(R"(NumberType="Char" Precision="1" Format="HDF">a&amp;b.h5:/points/status<)"));
}

TEST(Xdmf, ReadsThePlacesOfAScan) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  const PointPositions positions = positions_of(PointReader(folder / "scan.h5"), "true", "s.h5");
  EXPECT_EQ(positions.columns, (std::array<std::string, 3>{"x_true", "y_true", "z_true"}));
  EXPECT_EQ(positions.type, h5::Type::float64);
  EXPECT_EQ(positions.rows, 5U);
  EXPECT_EQ(positions.scan, "s.h5");
}

TEST(Xdmf, PlacesAGridByOriginAndStepSlowestFirst) {
  const std::string text = grid_xdmf({{"count", h5::Type::int32, "1", ""}}, {0.5, -3, -4, 7, 9}, "d.h5");
  EXPECT_THAT(text, HasSubstr(R"(TopologyType="3DCoRectMesh" Dimensions="1 7 9")"));
  EXPECT_THAT(text, HasSubstr(">0 -1.5 -2<"));
  EXPECT_THAT(text,
              HasSubstr(R"(Dimensions="1 7 9" NumberType="Int" Precision="4" Format="HDF">d.h5:/count<)"));
}

}  // namespace
}  // namespace landfall
