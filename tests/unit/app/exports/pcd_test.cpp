// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/exports/point_clouds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "memory_sink.h"
#include "small_scan.h"
#include "temporary_folder.h"
#include "test_maps.h"

namespace landfall {
namespace {

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
  EXPECT_THAT(sink.bytes(), testing::HasSubstr("# crs PROJCS[\"map\"]\n"));
  const std::string data = sink.bytes().substr(header + header_end.size());
  EXPECT_EQ(at<float>(data, 0), 2);
  EXPECT_EQ(at<float>(data, 4), -2);
  EXPECT_EQ(at<float>(data, 8), 2);
  EXPECT_EQ(at<double>(data, 12), 500202);
}

}  // namespace
}  // namespace landfall
