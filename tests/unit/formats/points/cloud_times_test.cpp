// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/cloud_times.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/core/error.h"
#include "cloud_files.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

}  // namespace
}  // namespace landfall
