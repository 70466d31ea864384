// SPDX-License-Identifier: GPL-3.0-or-later
// Offsets are those of the tables of LAS 1.4 R15 (ASPRS, 2019), formats 0 to 10.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "cloud_files.h"
#include "formats/points/row_reader.h"

namespace landfall {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsNan;

constexpr std::array<std::size_t, 11> kBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

std::string record(const std::string& user, std::uint16_t number, const std::string& content,
                   bool is_long = false) {
  std::string bytes(2, '\0');
  bytes += user + std::string(16 - user.size(), '\0');
  put(bytes, number);
  if (is_long)
    put(bytes, static_cast<std::uint64_t>(content.size()));
  else
    put(bytes, static_cast<std::uint16_t>(content.size()));
  return bytes + std::string(32, '\0') + content;
}

/// A LAS file whose points have X = i, Y = -i, Z = 2 i.
struct LasFile {
  int minor = 4;
  int format = 6;
  std::size_t points = 2;
  std::size_t extra = 0;
  std::uint32_t legacy_count = 0;
  std::uint64_t count = 2;
  std::uint16_t encoding = 0;
  std::vector<std::string> records{}, long_records{};

  [[nodiscard]] std::string point(std::size_t i) const {
    std::string bytes;
    put(bytes, static_cast<std::int32_t>(i));
    put(bytes, -static_cast<std::int32_t>(i));
    put(bytes, static_cast<std::int32_t>(2 * i));
    put(bytes, static_cast<std::uint16_t>(65535 - i));
    const auto number = static_cast<std::uint8_t>(1 + i % 5);
    const bool is_withheld = i == 1;
    if (format < 6) {
      put(bytes, static_cast<std::uint8_t>(number | 5U << 3U | 0xc0U));
      put(bytes, static_cast<std::uint8_t>((is_withheld ? 0x80 : 0) | 7));
      bytes += std::string(4, '\x7f');
    } else {
      put(bytes, static_cast<std::uint8_t>((number + 8U) | 15U << 4U));
      put(bytes, static_cast<std::uint8_t>(is_withheld ? 4 : 0));
      put(bytes, std::uint8_t{18});
      bytes += std::string(5, '\x7f');
    }
    if (format != 0 && format != 2) put(bytes, 1e5 + static_cast<double>(i));
    return bytes + std::string(kBytes.at(static_cast<std::size_t>(format)) + extra - bytes.size(), '\x7f');
  }
  [[nodiscard]] std::string bytes() const {
    const std::array<std::size_t, 5> headers = {227, 227, 227, 235, 375};
    const std::size_t header = headers.at(static_cast<std::size_t>(minor));
    std::string between;
    for (const std::string& each : records) between += each;
    std::string file = "LASF" + std::string(header - 4, '\0');
    file = patched(file, 6, encoding);
    file[24] = 1;
    file[25] = static_cast<char>(minor);
    file = patched(file, 94, static_cast<std::uint16_t>(header));
    file = patched(file, 96, static_cast<std::uint32_t>(header + between.size()));
    file = patched(file, 100, static_cast<std::uint32_t>(records.size()));
    file[104] = static_cast<char>(format);
    const std::size_t size = kBytes.at(static_cast<std::size_t>(format)) + extra;
    file = patched(file, 105, static_cast<std::uint16_t>(size));
    file = patched(file, 107, legacy_count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      file = patched(file, 131 + 8 * axis, 0.5);
      file = patched(file, 155 + 8 * axis, 100.0);
    }
    if (minor == 4) {
      file = patched(file, 235, static_cast<std::uint64_t>(header + between.size() + points * size));
      file = patched(file, 243, static_cast<std::uint32_t>(long_records.size()));
      file = patched(file, 247, count);
    }
    file += between;
    for (std::size_t i = 0; i < points; ++i) file += point(i);
    for (const std::string& each : long_records) file += each;
    return file;
  }
};

TEST(LasReader, ReadsEveryPointFormatAndSkipsExtraBytes) {
  for (int format = 0; format <= 10; ++format)
    for (const std::size_t extra : {0U, 3U}) {
      SCOPED_TRACE(format);
      const WholeCloud cloud = read_cloud("a.las", LasFile{.format = format, .extra = extra}.bytes());
      EXPECT_EQ(cloud.info.format, "LAS 1.4, point format " + std::to_string(format));
      EXPECT_THAT(cloud[CloudField::x], ElementsAre(100, 100.5));
      EXPECT_THAT(cloud[CloudField::y], ElementsAre(100, 99.5));
      EXPECT_THAT(cloud[CloudField::z], ElementsAre(100, 101));
      EXPECT_THAT(cloud[CloudField::intensity], ElementsAre(65535, 65534));
      const bool is_extended = format >= 6;
      EXPECT_THAT(cloud[CloudField::return_number], ElementsAre(is_extended ? 9 : 1, is_extended ? 10 : 2));
      EXPECT_THAT(cloud[CloudField::classification], ElementsAre(is_extended ? 18 : 7, kWithheld));
      const bool has_time = format != 0 && format != 2;
      EXPECT_EQ(cloud.info.has(CloudField::t), has_time);
      if (has_time) {
        EXPECT_THAT(cloud[CloudField::t], ElementsAre(1e5, 1e5 + 1));
      }
    }
}

// LAS 1.0 has no withheld flag: all bits are those of the class.
TEST(LasReader, ReadsEveryVersion) {
  for (int minor = 0; minor <= 3; ++minor) {
    const WholeCloud cloud =
        read_cloud("a.las", LasFile{.minor = minor, .format = 1, .legacy_count = 2}.bytes());
    EXPECT_THAT(cloud[CloudField::classification], ElementsAre(7, minor == 0 ? 0x87 : kWithheld));
    EXPECT_EQ(cloud.info.format, "LAS 1." + std::to_string(minor) + ", point format 1");
  }
}

TEST(LasReader, ReadsTheNumberOfReturns) {
  for (const int format : {0, 5, 6, 10})
    EXPECT_THAT(read_cloud("a.las", LasFile{.format = format}.bytes())[CloudField::number_of_returns],
                ElementsAre(format < 6 ? 5 : 15, format < 6 ? 5 : 15));
}

TEST(LasReader, ReadsEitherCountOf14) {
  const auto count = [](const LasFile& file) { return read_cloud("a.las", file.bytes()).info.point_count; };
  EXPECT_EQ(count({.format = 1, .points = 5, .legacy_count = 5, .count = 5}), 5);
  EXPECT_EQ(count({.format = 1, .points = 5, .legacy_count = 0, .count = 5}), 5);
  EXPECT_EQ(count({.format = 1, .points = 5, .legacy_count = 5, .count = 0}), 5);
  EXPECT_EQ(count({.minor = 2, .format = 1, .points = 5, .legacy_count = 5}), 5);
  EXPECT_THAT(cloud_refusal("a.las", LasFile{.count = std::uint64_t{1} << 60U}.bytes()),
              HasSubstr("a.las: declares 1152921504606846976 points, but has the bytes of 2"));
}

TEST(LasReader, RefusesCountsThatDiffer) {
  const auto refusal = [](const std::string& bytes) { return cloud_refusal("a.las", bytes); };
  EXPECT_THAT(refusal(LasFile{.format = 1, .points = 5, .legacy_count = 3, .count = 5}.bytes()),
              HasSubstr("declares 3 points in 32 bits, but 5 in 64 bits"));
  const std::string old = LasFile{.minor = 2, .format = 1, .legacy_count = 2}.bytes();
  EXPECT_EQ(refusal(patched(old, 127, std::uint32_t{2})), "accepted");
  EXPECT_THAT(refusal(patched(old, 127, std::uint32_t{3})), HasSubstr("declares 2 points, but 3 by return"));
  const std::string good = LasFile{}.bytes();
  EXPECT_EQ(refusal(patched(good, 367, std::uint64_t{2})), "accepted");
  EXPECT_THAT(refusal(patched(good, 367, ~std::uint64_t{0})),
              HasSubstr("declares 2 points, but 9223372036854775808 by return"));
}

// Whole points behind the points are not counted by the header; other bytes are padding.
TEST(LasReader, AccountsForTheBytesBehindThePoints) {
  const std::string record_behind = record("another", 1, "content", true);
  const LasFile plain{};
  const LasFile with_record{.long_records = {record_behind}};
  const auto notes = [](const std::string& bytes) { return read_cloud("a.las", bytes).info.notes; };
  for (const LasFile& file : {plain, with_record}) {
    const std::string bytes = file.bytes();
    EXPECT_THAT(notes(bytes), ElementsAre());
    EXPECT_THAT(cloud_refusal("a.las", bytes + std::string(60, 'x')),
                HasSubstr("declares 2 points, but the bytes of 2 more follow"));
    EXPECT_THAT(
        notes(bytes + std::string(61, 'x')),
        ElementsAre("has 61 bytes that belong to nothing that its header declares; they are not read"));
  }
  const std::string bytes = with_record.bytes();
  const auto begin = number_at<std::uint64_t>(std::as_bytes(std::span(bytes)), 235);
  const std::string apart = patched(bytes, 235, begin + 5);  // a gap between points and record
  EXPECT_THAT(notes(apart.substr(0, begin) + "gap.." + bytes.substr(begin)),
              ElementsAre(HasSubstr("has 5 bytes")));
  EXPECT_THAT(cloud_refusal("a.las", patched(bytes, 235, begin - 30)),
              HasSubstr("its points end at byte 435, but records behind them begin at byte 405"));
}

TEST(LasReader, AcceptsWaveformsBehindThePoints) {
  std::string bytes = LasFile{.minor = 3, .format = 4, .legacy_count = 2}.bytes();
  const auto begin = static_cast<std::uint64_t>(bytes.size());
  bytes = patched(bytes, 227, begin) + record("LASF_Spec", 65535, std::string(2 * 57 - 60, 'w'), true);
  EXPECT_THAT(read_cloud("a.las", bytes).info.notes, ElementsAre());
  EXPECT_THAT(read_cloud("a.las", patched(bytes, begin + 20, std::uint64_t{0})).info.notes, ElementsAre());
  EXPECT_THAT(read_cloud("a.las", bytes + "end").info.notes, ElementsAre(HasSubstr("has 3 bytes")));
}

TEST(LasReader, RefusesExtraBytesThatDoNotFit) {
  const auto fields = [](std::initializer_list<int> types) {
    std::string content;
    for (const int type : types)
      content += patched(std::string(192, '\0'), 2, static_cast<std::uint8_t>(type));
    return record("LASF_Spec", 4, content);
  };
  const auto refusal = [&](std::initializer_list<int> types, std::size_t extra) {
    return cloud_refusal("a.las", LasFile{.extra = extra, .records = {fields(types)}}.bytes());
  };
  EXPECT_EQ(refusal({1, 9, 23}, 11), "accepted");  // 1, 4 and 3 x 2 bytes
  EXPECT_EQ(refusal({10}, 20), "accepted");
  EXPECT_THAT(refusal({1, 9, 23}, 10),
              HasSubstr("declares points of 40 bytes with 11 extra ones; those of format 6 leave 10"));
}

// As RIEGL's programs describe it: the second of two numbers of 16 bits, in tenths of a nanosecond.
TEST(LasReader, TakesTheWidthOfEchoes) {
  const auto widths = [](unsigned options, const std::string& words) {
    const std::string number = patched(std::string(192, '\0'), 2, std::uint8_t{3});
    std::string width = patched(number, 3, static_cast<std::uint8_t>(options));
    width.replace(160, words.size(), words);
    const std::string described = record("LASF_Spec", 4, number + patched(width, 112, 0.1));
    std::string bytes = LasFile{.extra = 4, .records = {described}}.bytes();
    return read_cloud("a.las", patched(bytes, bytes.size() - 2, std::uint16_t{0}))[CloudField::echo_width];
  };
  const std::string words = "Full width at half maximum [ns]";
  const double nanosecond = 0.149896229 / 2.35482004503;
  EXPECT_THAT(widths(8, words), ElementsAre(DoubleNear(3263.9 * nanosecond, 1e-6), IsNan()));
  EXPECT_THAT(widths(0, words), ElementsAre(DoubleNear(32639 * nanosecond, 1e-5), IsNan()));
  EXPECT_THAT(widths(24, words), ElementsAre()) << "with an offset";
  EXPECT_THAT(widths(8, "Full width [m]"), ElementsAre());
}

TEST(LasReader, TellsTheExtentOfItsHeader) {
  std::string bytes = LasFile{}.bytes();
  for (std::size_t i = 0; i < 6; ++i) bytes = patched(bytes, 179 + 8 * i, static_cast<double>(i));
  const CloudBox box = read_cloud("a.las", bytes).info.box.value();
  EXPECT_THAT(box.high, ElementsAre(0, 2, 4));
  EXPECT_THAT(box.low, ElementsAre(1, 3, 5));
}

TEST(LasReader, TakesABlankWktAsNone) {
  for (const std::string& wkt : {std::string(3, '\0'), std::string(" \n"), std::string()}) {
    const CloudInfo info =
        read_cloud("a.las",
                   LasFile{.encoding = 16, .records = {record("LASF_Projection", 2112, wkt)}}.bytes())
            .info;
    EXPECT_EQ(info.crs_wkt, "");
    EXPECT_FALSE(info.geo_keys);
  }
}

// A batch of long points is bounded by bytes.
TEST(LasReader, ReadsLongPointsInSmallerBatches) {
  const std::size_t points = kMaxBatchBytes / 65535 + 1;
  const WholeCloud cloud =
      read_cloud("a.las", LasFile{.points = points, .extra = 65535 - 30, .count = points}.bytes(), {}, 2);
  ASSERT_EQ(cloud.batches.size(), 2U);
  EXPECT_EQ(cloud[CloudField::x].back(), 100 + 0.5 * static_cast<double>(points - 1));
}

TEST(LasReader, ReadsBatchAfterBatchAndAgain) {
  const std::size_t points = kCloudBatchPoints + 1;
  const WholeCloud cloud =
      read_cloud("a.las", LasFile{.format = 0, .points = points, .count = points}.bytes(), {}, 2);
  ASSERT_EQ(cloud.batches.size(), 2U);
  EXPECT_EQ(cloud.batches[0].size(), kCloudBatchPoints);
  EXPECT_EQ(cloud.batches[1][CloudField::x].at(0), 100 + 0.5 * static_cast<double>(kCloudBatchPoints));
}

TEST(LasReader, TakesTheCrsThatTheHeaderNames) {
  std::string keys;
  for (const int key : {1, 1, 0, 1, 3072, 0, 1, 32632}) put(keys, static_cast<std::uint16_t>(key));
  const std::vector<std::string> both = {record("LASF_Projection", 34735, keys),
                                         record("LASF_Projection", 2112, "PROJCS[]"),
                                         record("another", 2112, "not a CRS")};
  const auto info = [](const LasFile& file) { return read_cloud("a.las", file.bytes()).info; };
  EXPECT_EQ(info({.encoding = 16, .records = both}).crs_wkt, "PROJCS[]");
  EXPECT_FALSE(info({.encoding = 16, .records = both}).geo_keys);
  EXPECT_EQ(info({.records = both}).crs_wkt, "");
  EXPECT_THAT(info({.records = both}).geo_keys.value().directory, ElementsAre(1, 1, 0, 1, 3072, 0, 1, 32632));
  const LasFile behind{.long_records = {record("LASF_Projection", 2112, "GEOGCS[]", true)}};
  EXPECT_EQ(info(behind).crs_wkt, "GEOGCS[]");
}

TEST(LasReader, RefusesWhatDoesNotFit) {
  const std::string good = LasFile{}.bytes();
  const auto refusal = [](const std::string& bytes) { return cloud_refusal("a.las", bytes); };
  ASSERT_EQ(refusal(good), "accepted");
  EXPECT_THAT(refusal(good.substr(0, 226)), HasSubstr("ends within its header"));
  EXPECT_THAT(refusal(good.substr(0, 300)), HasSubstr("declares a header of 375 bytes; LAS 1.4"));
  EXPECT_THAT(refusal(LasFile{.points = 0, .count = 0}.bytes()), HasSubstr("has no points"));
  EXPECT_THAT(refusal(patched(good, 24, '\2')), HasSubstr("is LAS 2.4"));
  EXPECT_THAT(refusal(patched(good, 94, std::uint16_t{374})), HasSubstr("LAS 1.4 has at least 375"));
  EXPECT_THAT(refusal(patched(good, 96, std::uint32_t{374})), HasSubstr("its points begin at byte 374"));
  EXPECT_THAT(refusal(patched(good, 96, ~std::uint32_t{0})), HasSubstr("has the bytes of 0"));
  EXPECT_THAT(refusal(patched(good, 104, '\x86')), HasSubstr("laszip -i"));
  EXPECT_THAT(refusal(patched(good, 171, std::numeric_limits<double>::quiet_NaN())), HasSubstr("axis z"));
  EXPECT_THAT(refusal(patched(good, 243, std::uint32_t{1})), HasSubstr("reaches beyond its place"));
  const std::string behind = LasFile{.long_records = {record("LASF_Projection", 2112, "W", true)}}.bytes();
  EXPECT_THAT(refusal(patched(behind, behind.size() - 41, ~std::uint64_t{0})), HasSubstr("reaches beyond"));
  EXPECT_THAT(refusal(patched(behind, 235, ~std::uint64_t{0})), HasSubstr("reaches beyond its place"));
}

}  // namespace
}  // namespace landfall
