// SPDX-License-Identifier: GPL-3.0-or-later
#include "exports/point_clouds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "memory_sink.h"
#include "small_scan.h"
#include "temporary_folder.h"

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

}  // namespace
}  // namespace landfall
