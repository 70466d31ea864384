// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cloud_files.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A scanner at (100, 200, 300) whose x axis points north (a turn of 90 degrees about z).
std::string header(const std::string& size) {
  return size + "100 200 300\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 200 300 1\n";
}
const std::string kScan = header("2\n2\n") + "1 0 0 0.5\n0 2 0 0.25\n0 0 0 0.5\n1 2 3 1\n";
const std::string kTwoScans = kScan + header("1\n1\n") + "5 0 -1 0.75\n";

TEST(PtxReader, AppliesTheTransformationOfEachScan) {
  const WholeCloud cloud = read_cloud("a.ptx", kTwoScans, {}, 2);
  const std::vector<double> x = cloud[CloudField::x];
  ASSERT_EQ(x.size(), 5U);
  EXPECT_THAT(std::vector(x.begin(), x.begin() + 2), ElementsAre(100, 98));
  EXPECT_TRUE(std::isnan(x[2]));  // no return
  EXPECT_EQ(x[3], 98);
  EXPECT_THAT(cloud[CloudField::y], ElementsAre(201, 200, 200, 201, 205));
  EXPECT_THAT(cloud[CloudField::z], ElementsAre(300, 300, 300, 303, 299));
  EXPECT_THAT(cloud[CloudField::intensity], ElementsAre(0.5, 0.25, 0.5, 1, 0.75));
  EXPECT_EQ(cloud.info.format, "PTX");
}

TEST(PtxReader, ReadsColoursAndCarriageReturns) {
  std::string text = header("1\n1\n") + "1 0 0 0.5 10 20 30\n";
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 2))
    text.replace(at, 1, "\r\n");
  EXPECT_THAT(read_cloud("a", text)[CloudField::y], ElementsAre(201));
}

TEST(PtxReader, RefusesWhatDoesNotFit) {
  const auto refusal = [](const std::string& text) { return cloud_refusal("a.ptx", text); };
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(refusal(kScan.substr(0, kScan.rfind("1 2 3"))), HasSubstr("declares 4 points, but has 3"));
  EXPECT_THAT(refusal(kScan + "9 9 9 9\n"), HasSubstr("line 15: the file ends within the header"));
  EXPECT_THAT(refusal(with(kScan, "2\n2\n", "2\n0\n")), HasSubstr("line 2: a scan begins with the numbers"));
  EXPECT_THAT(refusal(with(kScan, "0 2 0 0.25", "0 2 0")), HasSubstr("line 12: has 3 cells, not 4"));
  EXPECT_THAT(refusal(with(kScan, "0 2 0 0.25", "0 b 0 0.25")), HasSubstr("line 12: 'b' is not a number"));
  EXPECT_THAT(refusal(kTwoScans.substr(0, kTwoScans.size() - 13)),
              HasSubstr("line 24: the file ends before the points"));
}

TEST(PtxReader, EveryTruncationIsRefusedOrEndsWithinTheLastNumber) {
  for (std::size_t size = 1; size < kTwoScans.size(); ++size) {
    const std::string refusal = cloud_refusal("a.ptx", kTwoScans.substr(0, size));
    const bool is_whole_scan = size == kScan.size() || size == kScan.size() - 1;
    const bool ends_in_last_number = size > kTwoScans.size() - 5;
    EXPECT_TRUE(refusal != "accepted" || is_whole_scan || ends_in_last_number) << size;
  }
}

struct QfitFile {
  std::int32_t words = 12;
  bool is_big_endian = true;
  std::int32_t offset_records = 3;

  [[nodiscard]] std::string record(const std::vector<std::int32_t>& values) const {
    std::string bytes;
    for (const std::int32_t value : values) put(bytes, value, is_big_endian);
    return bytes + std::string(static_cast<std::size_t>(4 * words) - bytes.size(), ' ');
  }
  [[nodiscard]] std::string shot(std::int32_t i) const {
    std::vector<std::int32_t> values(static_cast<std::size_t>(words), 77);
    values[0] = i;
    values[1] = 59'205'160 + i;
    values[2] = 221'826'822 - i;
    values[3] = -32'090 + i;
    values[5] = 900 + i;
    values.back() = 232'325'407 + i;
    return record(values);
  }
  [[nodiscard]] std::string bytes() const {
    return record({4 * words}) + record({-9'000'008, 4 * words * offset_records}) + record({-9'000'001}) +
           shot(0) + shot(1);
  }
};

TEST(QfitReader, ReadsRecordsOf10And12And14WordsInBothByteOrders) {
  for (const std::int32_t words : {10, 12, 14})
    for (const bool is_big_endian : {true, false}) {
      SCOPED_TRACE(std::to_string(words) + (is_big_endian ? " big" : " little"));
      const WholeCloud cloud = read_cloud("a.qi", QfitFile{words, is_big_endian}.bytes(), {}, 2);
      EXPECT_THAT(cloud[CloudField::x], ElementsAre(221.826822, 221.826821));
      EXPECT_THAT(cloud[CloudField::y], ElementsAre(59.20516, 59.205161));
      EXPECT_THAT(cloud[CloudField::z], ElementsAre(-32.09, -32.089));
      EXPECT_THAT(cloud[CloudField::intensity], ElementsAre(900, 901));
      const double t = 23 * 3600 + 23 * 60 + 25.407;
      EXPECT_THAT(cloud[CloudField::t], ElementsAre(t, testing::DoubleEq(t + 0.001)));
      EXPECT_THAT(cloud.info.crs_wkt, HasSubstr("4979"));
      EXPECT_EQ(cloud.info.point_count, 2);
    }
}

TEST(QfitReader, IsKnownByItsContent) {
  EXPECT_EQ(read_cloud("renamed.bin", QfitFile{}.bytes()).info.format, "QFIT, 12 words, big-endian");
}

TEST(QfitReader, AShotWithoutAPositionAndAHeaderRecordAreNoPoints) {
  const QfitFile file;
  const std::vector<double> x = read_cloud(
      "a.qi", file.bytes() + file.record({5, 0, 0, 0}) + file.record({-9'000'002, 1, 2, 3}))[CloudField::x];
  ASSERT_EQ(x.size(), 4U);
  EXPECT_TRUE(std::isnan(x[2]));
  EXPECT_TRUE(std::isnan(x[3]));
}

TEST(QfitReader, RefusesWhatDoesNotFit) {
  const auto refusal = [](const std::string& bytes) { return cloud_refusal("a.qi", bytes); };
  const std::string good = QfitFile{}.bytes();
  EXPECT_THAT(refusal(QfitFile{.words = 11}.bytes()), HasSubstr("its first word is not 40, 48 or 56"));
  EXPECT_THAT(refusal(QfitFile{.offset_records = 1}.bytes()), HasSubstr("begin at byte 48 by its header"));
  EXPECT_THAT(refusal(QfitFile{.offset_records = 99}.bytes()), HasSubstr("within the file"));
  EXPECT_THAT(refusal(QfitFile{.offset_records = 5}.bytes()), HasSubstr("has no points"));
  std::string word;
  put(word, 145, true);
  std::string odd = good;
  EXPECT_THAT(refusal(odd.replace(52, 4, word)), HasSubstr("a multiple of its 48 bytes per record"));
}

TEST(QfitReader, EveryTruncationIsRefusedUnlessItEndsWithARecord) {
  const std::string good = QfitFile{}.bytes();
  for (std::size_t size = 1; size < good.size(); ++size) {
    const bool ends_with_a_shot = size == good.size() - 48;
    EXPECT_EQ(cloud_refusal("a.qi", good.substr(0, size)) == "accepted", ends_with_a_shot) << size;
  }
}

}  // namespace
}  // namespace landfall
