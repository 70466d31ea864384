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

}  // namespace
}  // namespace landfall
