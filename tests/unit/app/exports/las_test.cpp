// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/exports/las.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "base/core/error.h"
#include "memory_sink.h"
#include "refusal.h"
#include "small_scan.h"
#include "temporary_folder.h"
#include "test_maps.h"

namespace landfall {
namespace {

std::string las(const SmallScan& scan, std::size_t every = 1, LasTime time = LasTime::scan) {
  const TemporaryFolder folder;
  scan.write(folder / "scan.h5");
  MemorySink sink;
  const std::vector<std::string> remarks = write_points_las(
      PointReader(folder / "scan.h5"),
      {.every = every, .time = time, .software = "landfall-export 1.2.3 (a very long name)"}, sink);
  EXPECT_THAT(remarks, testing::IsEmpty());
  return sink.bytes();
}

// Offsets of the public header block, LAS 1.2 (ASPRS, 2 September 2008), table 1.
TEST(PointsLas, HasTheHeaderOfThePaper) {
  const std::string file = las({});
  EXPECT_EQ(file.substr(0, 4), "LASF");
  EXPECT_EQ(at<std::uint8_t>(file, 24), 1);
  EXPECT_EQ(at<std::uint8_t>(file, 25), 2);
  EXPECT_EQ(file.substr(58, 32), "landfall-export 1.2.3 (a very lo");
  EXPECT_EQ(at<std::uint32_t>(file, 90), 0U);  // day and year
  EXPECT_EQ(at<std::uint16_t>(file, 94), 227);
  const auto begin = at<std::uint32_t>(file, 96);
  EXPECT_EQ(at<std::uint32_t>(file, 100), 1U);
  EXPECT_EQ(at<std::uint8_t>(file, 104), 1);
  EXPECT_EQ(at<std::uint16_t>(file, 105), 28);
  EXPECT_EQ(at<std::uint32_t>(file, 107), 4U);
  EXPECT_EQ(at<std::uint32_t>(file, 111), 4U);
  EXPECT_EQ(at<std::uint32_t>(file, 115), 0U);
  EXPECT_EQ(file.size(), begin + 4 * kLasPointBytes);
  EXPECT_EQ(at<double>(file, 131), 1e-6);
  EXPECT_EQ(at<double>(file, 155), 2);  // centre of 1 .. 3
  EXPECT_EQ(at<double>(file, 179), 3);  // greatest x, then least
  EXPECT_EQ(at<double>(file, 187), 1);
  EXPECT_EQ(at<double>(file, 195), -1);
  EXPECT_EQ(at<double>(file, 219), 2);  // least z
  EXPECT_EQ(file.substr(227 + 2, 8), "landfall");
  EXPECT_EQ(at<std::uint16_t>(file, 227 + 20), begin - 227 - 54);
}

TEST(PointsLas, HoldsPlaceTimeAndClass) {
  const std::string file = las({});
  const std::size_t third = at<std::uint32_t>(file, 96) + 2 * kLasPointBytes;  // the false return
  EXPECT_EQ(at<std::int32_t>(file, third), 500000);
  EXPECT_EQ(at<std::int32_t>(file, third + 4), -500000);
  EXPECT_EQ(at<std::int32_t>(file, third + 8), 1000000);
  EXPECT_EQ(at<std::uint8_t>(file, third + 14), 0b001'001);
  EXPECT_EQ(at<std::uint8_t>(file, third + 15), 7);
  EXPECT_EQ(at<std::uint8_t>(file, third + 15 - kLasPointBytes), 1);
  EXPECT_EQ(at<double>(file, third + 20), 0.25);
}

/// The GPS time of the last point, and the global encoding.
std::pair<double, int> time_and_encoding(const SmallScan& scan, LasTime time) {
  const std::string file = las(scan, 1, time);
  return {at<double>(file, file.size() - 8), at<std::uint16_t>(file, 6)};
}

// LAS 1.2, table 2: with bit 0 of the global encoding, times are GPS seconds less 1e9; without, small
// numbers.
TEST(PointsLas, TimesFitTheGlobalEncoding) {
  const SmallScan gps{.t = {1.4e9, 1.4e9 + 0.25, 1.4e9 + 0.5}};
  EXPECT_EQ(time_and_encoding(gps, LasTime::scan), std::pair(0.5, 0));
  EXPECT_EQ(time_and_encoding(gps, LasTime::gps), std::pair(4e8 + 0.5, 1));
  EXPECT_EQ(time_and_encoding({}, LasTime::gps), std::pair(-1e9 + 0.5, 1));
}

TEST(PointsLas, RefusesTimesBeforeTheGpsClock) {
  const SmallScan early{.t = {-1, -0.75, -0.5}};
  EXPECT_EQ(time_and_encoding(early, LasTime::scan), std::pair(0.5, 0));
  EXPECT_THAT([&] { las(early, 1, LasTime::gps); },
              testing::ThrowsMessage<UsageError>(testing::HasSubstr("a pulse is at -1 s")));
}

TEST(PointsLas, BoundsAreThoseOfTheSelectedPoints) {
  const std::string file = las({}, 2);  // x = 1 and 2.5
  EXPECT_EQ(at<std::uint32_t>(file, 107), 2U);
  EXPECT_EQ(at<double>(file, 179), 2.5);
}

TEST(LasGrid, TakesTheFinestScaleThatFits) {
  const auto box = [](double half) { return PointBox{{-half, -1, -1}, {half, 1, 1}}; };
  EXPECT_EQ(LasGrid::fitting(box(2147), "f").scale[0], 1e-6);
  EXPECT_EQ(LasGrid::fitting(box(2148), "f").scale[0], 1e-5);
  EXPECT_EQ(LasGrid::fitting(box(21475), "f").scale[0], 1e-4);
  EXPECT_THAT(refusal<FormatError>([&] { return LasGrid::fitting(box(214750), "f"); }),
              testing::HasSubstr("f: points reach 214750 m from their centre; LAS allows 214748 m"));
}

TEST(LasGrid, StoresWithinHalfAStep) {
  const LasGrid grid = LasGrid::fitting({{-3000, 7, -0.5}, {5000, 9, 0.25}}, "f");
  EXPECT_EQ(grid.scale[0], 1e-5);
  EXPECT_EQ(grid.offset, (std::array<double, 3>{1000, 8, -0.0}));
  for (const double x : {-3000.0, -1234.567891, 0.1234567, 4999.999999, 5000.0})
    EXPECT_NEAR(grid.read_back(grid.stored(x, 0), 0), x, 0.51e-5);
}

TEST(PointsLas, RefusesAScanWithoutReturns) {
  SmallScan scan;
  scan.status = {1, 1, 2, 3, 4};
  EXPECT_THAT(refusal<FormatError>([&] { return las(scan); }), testing::EndsWith("scan.h5: holds no return"));
}

std::string las_on(const MapFrame& map) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  PointReader points(folder / "scan.h5");
  points.place_on(map);
  MemorySink sink;
  static_cast<void>(write_points_las(points, {.software = "a"}, sink));
  return sink.bytes();
}

// Offsets of the public header block, LAS 1.4 R15 (ASPRS, 9 July 2019), table 3.
TEST(PointsLas, OnAMapIsLas14WithItsCrs) {
  const std::string file = las_on(planar_map());
  EXPECT_EQ(at<std::uint16_t>(file, 6), 0x10);  // the CRS is WKT
  EXPECT_EQ(at<std::uint8_t>(file, 25), 4);
  EXPECT_EQ(at<std::uint16_t>(file, 94), 375);
  const auto begin = at<std::uint32_t>(file, 96);
  EXPECT_EQ(at<std::uint32_t>(file, 100), 2U);
  EXPECT_EQ(at<std::uint32_t>(file, 107), 4U);
  EXPECT_EQ(at<double>(file, 155), 500004);   // centre of 500002 .. 500006
  EXPECT_EQ(at<double>(file, 163), 5399997);  // of 5399994.5 .. 5399998.5, rounded
  EXPECT_EQ(at<double>(file, 179), 500006);
  EXPECT_EQ(at<double>(file, 219), 302);
  EXPECT_EQ(at<std::uint64_t>(file, 247), 4U);
  EXPECT_EQ(at<std::uint64_t>(file, 255), 4U);
  EXPECT_EQ(at<std::uint64_t>(file, 263), 0U);
  const std::size_t record = 375 + 54 + at<std::uint16_t>(file, 375 + 20);
  EXPECT_EQ(file.substr(record + 2, 15), "LASF_Projection");
  EXPECT_EQ(at<std::uint16_t>(file, record + 18), 2112);
  EXPECT_EQ(file.substr(record + 54, begin - record - 54), std::string("PROJCS[\"map\"]") + '\0');
  EXPECT_EQ(at<std::int32_t>(file, begin), -2000000);
  EXPECT_EQ(file.size(), begin + 4 * kLasPointBytes);
}

TEST(PointsLas, DegreesHaveAFinerScaleThanHeights) {
  const std::string file = las_on(geographic_map());
  EXPECT_EQ(at<double>(file, 131), 1e-9);
  EXPECT_EQ(at<double>(file, 139), 1e-9);
  EXPECT_EQ(at<double>(file, 147), 1e-6);
  const auto begin = at<std::uint32_t>(file, 96);
  EXPECT_EQ(at<std::int32_t>(file, begin), 10000);
  EXPECT_EQ(at<std::int32_t>(file, begin + 4), -20000);
  EXPECT_EQ(LasGrid::fitting({{-180, -90, 0}, {180, 90, 1}}, "f", geographic_map()).scale[0], 1e-7);
}

}  // namespace
}  // namespace landfall
