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
  EXPECT_THAT(sink.bytes(), testing::HasSubstr("comment landfall points: coordinates in map, z up, unit m\n"
                                               "comment crs PROJCS[\"map\"]\n"));
  EXPECT_THAT(sink.bytes(),
              testing::HasSubstr("comment x: easting, easting, estimated position in map, unit ft\n"));
  const std::string data = sink.bytes().substr(sink.bytes().find("end_header\n") + 11);
  EXPECT_EQ(at<double>(data, 0), 500002);
  EXPECT_EQ(at<double>(data, 8), 5399998.5);
  EXPECT_EQ(at<double>(data, 16), 302);
}

}  // namespace
}  // namespace landfall
