// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/core/error.h"
#include "cloud_files.h"
#include "formats/points/cloud_axes.h"
#include "formats/points/cloud_box.h"
#include "formats/points/cloud_times.h"
#include "formats/points/cloud_units.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

CloudInfo info_of() {
  CloudInfo info;
  info.steps = {.scale = {1, 2, 3}, .offset = {10, 20, 30}};
  info.box = {.low = {0, -5, 7}, .high = {1, 6, 9}};
  return info;
}

TEST(CloudAxes, LeaveOtherFilesAlone) {
  CloudBatch batch;
  batch.columns[0] = {1};
  batch.columns[1] = {2};
  batch.columns[2] = {3};
  rotate({}, batch);
  EXPECT_THAT(batch.columns[1], ElementsAre(2));
  CloudInfo info = info_of();
  rotate({}, info);
  EXPECT_THAT(info.box->low, ElementsAre(0, -5, 7));
}

TEST(CloudAxes, TurnYUp) {
  CloudBatch batch;
  batch.columns[0] = {1, 4};
  batch.columns[1] = {2, 5};
  batch.columns[2] = {3, -6};
  rotate({.y_up = true}, batch);
  EXPECT_THAT(batch.columns[0], ElementsAre(1, 4));
  EXPECT_THAT(batch.columns[1], ElementsAre(-3, 6));
  EXPECT_THAT(batch.columns[2], ElementsAre(2, 5));
  CloudInfo info = info_of();
  rotate({.y_up = true}, info);
  EXPECT_THAT(info.box->low, ElementsAre(0, -9, -5));
  EXPECT_THAT(info.box->high, ElementsAre(1, -7, 6));
  EXPECT_THAT(info.steps->scale, ElementsAre(1, 3, 2));
}

TEST(CloudAxes, SwapLatitudeAndLongitude) {
  CloudBatch batch;
  batch.columns[0] = {39};
  batch.columns[1] = {-83};
  batch.columns[2] = {1};
  rotate({.latitude_first = true}, batch);
  EXPECT_THAT(batch.columns[0], ElementsAre(-83));
  EXPECT_THAT(batch.columns[1], ElementsAre(39));
  CloudInfo info = info_of();
  rotate({.latitude_first = true}, info);
  EXPECT_THAT(info.box->high, ElementsAre(6, 1, 9));
  EXPECT_THAT(info.steps->offset, ElementsAre(20, 10, 30));
  CloudInfo none;
  rotate({.latitude_first = true, .y_up = true}, none);
  EXPECT_FALSE(none.box);
}

constexpr CloudBox kBox{.low = {0, 0, 0}, .high = {100, 50, 10}};
constexpr CloudSteps kSteps{.scale = {0.01, -0.01, 0.01}, .offset = {0, 0, 0}};

std::string verdict(const CloudBox& declared, const CloudBox& points, const CloudSteps& steps = kSteps) {
  try {
    return compare_with_box("a.las", declared, points, steps);
  } catch (const FormatError& error) {
    return error.what();
  }
}

TEST(CloudBox, AllowsTwoStepsWarnsAndRefusesByOnePerCentOfTheLongestEdge) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool is_high : {false, true}) {
      const auto beyond = [&](double by) {
        CloudBox points = kBox;
        if (is_high)
          points.high[axis] += by;
        else
          points.low[axis] -= by;
        return verdict(kBox, points);
      };
      EXPECT_EQ(beyond(0), "");
      EXPECT_EQ(beyond(0.02), "");
      EXPECT_THAT(beyond(0.03), HasSubstr(std::string("its points are in ") + "xyz"[axis]));
      EXPECT_THAT(beyond(0.99), HasSubstr("but its header declares [0, "));
      EXPECT_THAT(beyond(0.99), testing::Not(HasSubstr("a.las")));
      EXPECT_THAT(beyond(1.01), HasSubstr("a.las: its points are in "));
    }
  EXPECT_EQ(verdict(kBox, {.low = {50, 25, 5}, .high = {51, 26, 6}}), "");
}

// A box of some steps: rounding by one step is more than 1 % of it.
TEST(CloudBox, AllowsOneStepAroundASmallBox) {
  const CloudBox small{.low = {0, 0, 0}, .high = {0.1, 0.1, 0.1}};
  EXPECT_EQ(verdict(small, {.low = {-0.01, 0, 0}, .high = {0.1, 0.11, 0.1}}), "");
  EXPECT_THAT(verdict(small, {.low = {-0.02, 0, 0}, .high = {0.1, 0.1, 0.1}}), HasSubstr("are damaged"));
}

TEST(CloudBox, WarnsOfABoxThatSaysNothing) {
  const CloudBox points{.low = {1, 1, 1}, .high = {2, 2, 2}};
  EXPECT_THAT(verdict({}, points), HasSubstr("is all zero"));
  CloudBox wrong = kBox;
  wrong.high[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(verdict(wrong, points), HasSubstr("is not finite"));
}

TimeScale scale_of(const TimeExtent& times, std::optional<TimeUnit> unit = std::nullopt,
                   const CloudInfo& info = {}) {
  return time_scale("a.csv", info, unit, times);
}

std::string time_refusal(const TimeExtent& times, const CloudInfo& info = {}) {
  return refusal<FormatError>([&] { return scale_of(times, std::nullopt, info); });
}

TEST(CloudTimes, AsksForTheUnitBeyond1e12) {
  EXPECT_EQ(time_refusal({1e12, 1e12}), "accepted");
  EXPECT_THAT(time_refusal({1.5e12, 1.6e12}), HasSubstr("a.csv: a time of 1600000000000 is not in seconds"));
  EXPECT_THAT(time_refusal({-2e12, 0}), HasSubstr("a.csv: a time of"));
  CloudInfo info;
  info.time_base = 1'770'000'000'000'000'001;
  EXPECT_THAT(time_refusal({0, 5}, info), HasSubstr("a time of 1770000000000000006 is"));
  info.clock = "GPS seconds";  // as LAS says
  EXPECT_EQ(time_refusal({0, 5}, info), "accepted");
}

TEST(CloudTimes, ConvertsEveryUnitFromItsZero) {
  EXPECT_EQ(scale_of({1, 3}).seconds(3), 3);
  EXPECT_EQ(scale_of({1, 3}, TimeUnit::s).seconds(3), 3);
  EXPECT_EQ(scale_of({1, 3}, TimeUnit::ms).seconds(3), 3e-3);
  EXPECT_EQ(scale_of({1, 3}, TimeUnit::us).seconds(3), 3e-6);
  EXPECT_EQ(scale_of({1, 3}, TimeUnit::ns).seconds(3), 3e-9);
}

TEST(CloudTimes, LargeTimesCountFromTheFirst) {
  CloudInfo info;
  info.time_base = 1'770'000'000'000'000'001;
  const TimeScale scale = scale_of({-4, 6}, TimeUnit::ns, info);
  EXPECT_EQ(scale.seconds(-4), 0);
  EXPECT_EQ(scale.seconds(6), 1e-8);
  EXPECT_EQ(scale.clock, "seconds since 1769999999999999997 ns on the clock of the source");
  EXPECT_EQ(scale_of({1.77e12, 1.77e12 + 1}, TimeUnit::ms).seconds(1.77e12 + 1), 1e-3);
  EXPECT_EQ(scale_of({2e12, 2e12 + 1}, TimeUnit::s).seconds(2e12 + 1), 2e12 + 1);
}

TEST(CloudTimes, WarnsOfMoreThanADay) {
  EXPECT_EQ(scale_of({5, 86405}).warning, "");
  EXPECT_THAT(scale_of({5, 86406}).warning, HasSubstr("span 86401 s, which is more than a day"));
  EXPECT_EQ(scale_of({0, 1e8}, TimeUnit::ns).warning, "");
  EXPECT_THAT(scale_of({0, 1e8}, TimeUnit::ms).warning, HasSubstr("is their unit ms?"));
  CloudInfo las;
  las.clock = "GPS seconds";
  EXPECT_EQ(scale_of({0, 1e9}, std::nullopt, las).warning, "");
}

TEST(CloudTimes, KnowsFourUnits) {
  for (const char* const name : {"s", "ms", "us", "ns"}) EXPECT_STREQ(name_of(time_unit(name)), name);
  EXPECT_THROW(static_cast<void>(time_unit("min")), UsageError);
}

// Integers beyond 2^53 keep all digits from the file on.
TEST(CloudTimes, ReadsLargeIntegersExactly) {
  const auto times = [](const WholeCloud& cloud) { return cloud[CloudField::t]; };
  const WholeCloud text = read_cloud(
      "a.csv",
      "x,y,z,t\n0,0,0,1770000000000000001\n1,0,0,\"1770000000000000004\"\n2,0,0,-9223372036854775808\n");
  EXPECT_EQ(text.info.time_base, 1'770'000'000'000'000'001);
  EXPECT_THAT(times(text), ElementsAre(0, 3, -9223372036854775808.0 - 1.77e18));
  EXPECT_EQ(read_cloud("a.csv", "x,y,z,t\n0,0,0,9007199254740992\n").info.time_base, 0);
  std::string packed_header = "VERSION 0.7\nFIELDS x y z t\nSIZE 4 4 4 8\nTYPE F F F U\nWIDTH 2\nHEIGHT 1\n";
  std::string rows;
  for (const std::uint64_t t : {1'770'000'000'000'000'001U, 1'770'000'000'000'000'004U}) {
    for (const float x : {1.F, 2.F, 3.F}) put(rows, x);
    put(rows, t);
  }
  const WholeCloud binary = read_cloud("a.pcd", packed_header + "DATA binary\n" + rows);
  EXPECT_THAT(times(binary), ElementsAre(0, 3));
  EXPECT_EQ(binary.info.time_base, 1'770'000'000'000'000'001);
  std::string packed("\x17", 1);  // a run of 24 literal bytes, and one of 16
  packed += std::string(24, '\1') + "\x0f" + rows.substr(12, 8) + rows.substr(32, 8);
  std::string sizes;
  put(sizes, static_cast<std::uint32_t>(packed.size()));
  put(sizes, std::uint32_t{40});
  EXPECT_THAT(times(read_cloud("a.pcd", packed_header + "DATA binary_compressed\n" + sizes + packed, {}, 2)),
              ElementsAre(0, 3));
}

UnitConversion conversion_of(const std::string& header, bool has_crs,
                             std::optional<double> vertical_scale = {}) {
  return unit_conversion(read_cloud("a.csv", header + "\n1,2,3,4\n").info, has_crs, vertical_scale);
}

TEST(CloudUnits, EachColumnIsConvertedByItsOwnUnit) {
  const UnitConversion conversion = conversion_of("x [km],y [mm],z [ft],t [ms]", false);
  EXPECT_THAT(conversion.factors, ElementsAre(1000, 0.001, 0.3048, 1, 1, 1, 0.001, 1, 1, 1, 1));
  EXPECT_THAT(conversion.notes,
              ElementsAre(HasSubstr("x in km, y in mm, z in ft: converted to metres"), HasSubstr("t in ms")));
  EXPECT_THAT(conversion_of("x [m],y [m],z [m],t [s]", false).notes, IsEmpty());
}

TEST(CloudUnits, WithACrsTheMapKeepsItsUnit) {
  const UnitConversion conversion = conversion_of("x [km],y [km],z [ft],t", true);
  EXPECT_THAT(conversion.factors, ElementsAre(1, 1, 0.3048, 1, 1, 1, 1, 1, 1, 1, 1));
}

TEST(CloudUnits, TheVerticalScaleOfTheUserWins) {
  const UnitConversion conversion = conversion_of("x [m],y [m],z [ft],t", false, 2);
  EXPECT_EQ(conversion.factors[2], 1);
  EXPECT_THAT(conversion.notes, ElementsAre(HasSubstr("gives z in ft, but --vertical-scale 2 is taken")));
  EXPECT_THAT(conversion_of("x [m],y [m],z [ft],t", false, 0.3048).notes, IsEmpty());
}

TEST(CloudUnits, TheReaderMultipliesEveryPass) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.csv") << "x [mm],y [mm],z [ft]\n1000,2000,10\n";
  std::unique_ptr<CloudReader> cloud = open_cloud(folder / "a.csv");
  const UnitConversion conversion = unit_conversion(cloud->info(), false, {});
  cloud = converted(std::move(cloud), conversion);
  for (int pass = 0; pass < 2; ++pass) {
    CloudBatch batch;
    ASSERT_TRUE(cloud->next(batch));
    EXPECT_THAT(batch[CloudField::x], ElementsAre(1));
    EXPECT_THAT(batch[CloudField::z], ElementsAre(testing::DoubleEq(3.048)));
    EXPECT_FALSE(cloud->next(batch));
    cloud->rewind();
  }
}

}  // namespace
}  // namespace landfall
