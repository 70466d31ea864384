// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cloud_files.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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
