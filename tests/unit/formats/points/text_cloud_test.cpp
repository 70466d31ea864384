// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cloud_files.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string joined(const std::vector<std::string>& cells, const std::string& separator) {
  std::string line;
  for (const std::string& cell : cells) line += (line.empty() ? "" : separator) + cell;
  return line;
}

TEST(TextCloud, ReadsEverySeparatorAndEndOfLine) {
  for (const std::string separator : {",", ";", "\t", " ", "   ", ", ", ";\t"})
    for (const std::string end : {"\n", "\r\n", "\r"})
      for (const bool has_header : {true, false}) {
        SCOPED_TRACE("'" + separator + "', header: " + std::to_string(has_header));
        std::string text = has_header ? joined({"Easting", "N", "H"}, separator) + end : "";
        text += joined({"1.5", "-2e1", "3"}, separator) + end + joined({"4", "5", "6"}, separator);
        const WholeCloud cloud = read_cloud("a.csv", text, {}, 2);
        EXPECT_THAT(cloud[CloudField::x], ElementsAre(1.5, 4));
        EXPECT_THAT(cloud[CloudField::y], ElementsAre(-20, 5));
        EXPECT_THAT(cloud[CloudField::z], ElementsAre(3, 6));
        EXPECT_EQ(cloud.info.notes.size(), has_header ? 0U : 1U);
      }
}

TEST(TextCloud, ReadsHeadersInCommentsAndInQuotes) {
  for (const std::string header : {"# z y x", "//Z Y X", "% by a test\n# Z Y X", "\xef\xbb\xbfz y x"}) {
    const WholeCloud cloud = read_cloud("a.xyz", header + "\n3 2 1\n# a comment\n\n6 5 4\n");
    EXPECT_THAT(cloud[CloudField::x], ElementsAre(1, 4)) << header;
    EXPECT_THAT(cloud.info.notes, IsEmpty());
  }
  EXPECT_THAT(read_cloud("a.csv", "\"x\",'y [m]',z\n\"1\",\"2\",\"3\"\n")[CloudField::y], ElementsAre(2));
}

TEST(TextCloud, ACommentWithAsManyNamesAsColumnsIsTheHeader) {
  const auto first_x = [](const std::string& text) { return read_cloud("a.txt", text)[CloudField::x].at(0); };
  EXPECT_EQ(first_x("# LFID SHOT TIME X Y Z\n9 8 7 1 2 3\n"), 1);
  EXPECT_EQ(first_x("//X [m], Y [m], Z [m], Intensity\n1 2 3 4\n"), 1);
  EXPECT_EQ(first_x("# made by a tool\n1 2 3\n"), 1);  // three words that are no names of fields
  EXPECT_THAT(cloud_refusal("a.txt", "# LFID SHOT TIME FOO BAR\n9 8 7 1 2\n"),
              HasSubstr("no column is recognised as x; it has LFID, SHOT, TIME"));
}

TEST(TextCloud, SaysThatTheUnitOfACommentIsIgnored) {
  EXPECT_THAT(read_cloud("a.txt", "# Units: mm\nx,y,z\n1,2,3\n").info.notes,
              ElementsAre(HasSubstr("its comment 'Units: mm' is ignored")));
  EXPECT_THAT(read_cloud("a.txt", "# Units: m\nx,y,z\n1,2,3\n").info.notes, IsEmpty());
}

TEST(TextCloud, NamesMayHaveBlanksOrAnotherSeparator) {
  EXPECT_THAT(read_cloud("a.txt", "x [mm] y [mm] z [US ft]\n1 2 3\n").info.units[2].text, "US ft");
  EXPECT_THAT(read_cloud("a.txt", "Return Number\tX\tY\tZ\n1\t2\t3\t4\n")[CloudField::x], ElementsAre(2));
  EXPECT_THAT(read_cloud("a.txt", "X Y Z\n1,2,3\n")[CloudField::z], ElementsAre(3));
}

TEST(TextCloud, AMissingCellHasNoValue) {
  for (const std::string row : {"1,,3", "1,NA,3", "1,null,3", "1,N/A,3", "1,nan,3", "1,\"NA\",3"})
    EXPECT_TRUE(std::isnan(read_cloud("a.csv", "x,y,z\n" + row + "\n")[CloudField::y].at(0))) << row;
  EXPECT_TRUE(std::isnan(read_cloud("a.csv", "x,y,z\n1,2,\n")[CloudField::z].at(0)));
  EXPECT_TRUE(std::isnan(read_cloud("a.csv", "x\ty\tz\n1\t2\t\n")[CloudField::z].at(0)));
  EXPECT_TRUE(std::isnan(read_cloud("a.csv", "x\ty\tz\n\t2\t3\n")[CloudField::x].at(0)));
}

TEST(TextCloud, LeavesColumnsOfTextOut) {
  const std::string text = "timestamp,x,y,z,classification\n2026-03-05T12:00:00Z,1,2,3,ground\n";
  const WholeCloud cloud = read_cloud("a.csv", text);
  EXPECT_THAT(cloud[CloudField::x], ElementsAre(1));
  EXPECT_FALSE(cloud.info.has(CloudField::t));
  EXPECT_FALSE(cloud.info.has(CloudField::classification));
  EXPECT_THAT(
      cloud.info.notes,
      ElementsAre(HasSubstr("column timestamp is left out: it holds text, such as '2026-03-05T12:00:00Z'"),
                  HasSubstr("column classification is left out")));
  EXPECT_THAT(read_cloud("a.csv", text, column_choice("t=-,classification=-")).info.notes, IsEmpty());
  EXPECT_THAT(cloud_refusal("a.csv", text, column_choice("t=timestamp")), HasSubstr("is not a number"));
  const WholeCloud bare = read_cloud("a.csv", "ground,1,2,3\nrock,4,5,6\n");
  EXPECT_THAT(bare[CloudField::x], ElementsAre(1, 4));
  EXPECT_THAT(bare.info.notes, ElementsAre(HasSubstr("columns 2, 3, 4 are taken as x, y, z")));
}

TEST(TextCloud, LeavesAnUnnamedFirstColumnOut) {
  for (const std::string text :
       {"x,y,z\n1,5,6,7\n2,8,9,10\n", ",x,y,z\n1,5,6,7\n2,8,9,10\n",
        "\"\",\"x\",\"y\",\"z\"\n\"1\",5,6,7\n\"2\",8,9,10\n", "x y z\n\"a\" 5 6 7\n\"b\" 8 9 10\n",
        "\tx\ty\tz\n0\t5\t6\t7\n1\t8\t9\t10\n"}) {
    const WholeCloud cloud = read_cloud("a.csv", text);
    EXPECT_THAT(cloud[CloudField::x], ElementsAre(5, 8)) << text;
    EXPECT_THAT(cloud.info.notes, ElementsAre(HasSubstr("first column has no name"))) << text;
  }
}

TEST(TextCloud, ReadsDecimalCommas) {
  for (const std::string text :
       {"1,5;-2,25;3\n4;5;6,125\n", "1,5\t-2,25\t3\n4\t5\t6,125\n", "1,5 -2,25 3\n4 5 6,125\n",
        "4;5;6\n1,5;-2,25;3\n", "x;y;z\n1,5;-2,25;3\n4;5;6,125\n"}) {
    const WholeCloud cloud = read_cloud("a.txt", text);
    EXPECT_THAT(cloud[CloudField::x], testing::UnorderedElementsAre(1.5, 4)) << text;
    EXPECT_THAT(cloud.info.notes, testing::Contains(HasSubstr("decimals"))) << text;
  }
  EXPECT_THAT(cloud_refusal("a.txt", "x;y;z\n1,234,567;2;3\n"), HasSubstr("'1,234,567' is not a number"));
}

TEST(TextCloud, TakesTheCountAtTheBeginningOfPts) {
  EXPECT_EQ(read_cloud("a.pts", "2\n1 2 3\n4 5 6\n").info.point_count, 2);
  EXPECT_THAT(cloud_refusal("a.pts", "3\n1 2 3\n4 5 6\n"), HasSubstr("declares 3 points, but has 2"));
  EXPECT_THAT(cloud_refusal("a.pts", "1\n1 2 3\n4 5 6\n"), HasSubstr("declares 1 points, but has more"));
  EXPECT_THAT(cloud_refusal("a.pts", "0\n1 2 3\n"), HasSubstr("has no points"));
}

TEST(TextCloud, KnowsTheColumnsOfHelios) {
  const std::string row = "1 2 3 100.5 0 1 2 7 3 0 0.5\n";
  const WholeCloud cloud = read_cloud("leg000_points.xyz", row);
  EXPECT_EQ(cloud.info.format, "HELIOS++ xyz");
  EXPECT_THAT(cloud[CloudField::pulse], ElementsAre(7));
  EXPECT_THAT(cloud[CloudField::return_number], ElementsAre(1));
  EXPECT_THAT(cloud[CloudField::t], ElementsAre(0.5));
  EXPECT_EQ(read_cloud("a.xyz", "1 2 3 100.5 0 3 2 7 3 0 0.5\n").info.format, "text without a header");
}

// Blocks have 8 MiB, and pieces of them 256 KiB.
TEST(TextCloud, ReadsBlockAfterBlock) {
  std::string text = "x,y,z\n";
  constexpr int kRows = 420'000;
  for (int i = 0; i < kRows; ++i) text += std::to_string(i) + ",0.000000,0.500000\n";
  const WholeCloud cloud = read_cloud("a.csv", text);
  EXPECT_GT(cloud.batches.size(), 1U);
  const std::vector<double> x = cloud[CloudField::x];
  ASSERT_EQ(x.size(), std::size_t{kRows});
  for (std::size_t i = 0; i < x.size(); i += 1009) EXPECT_EQ(x[i], static_cast<double>(i));
  EXPECT_THAT(cloud_refusal("a.csv", text + "1,2\n"), HasSubstr("line 420002: has 2 cells, not 3"));
}

// Comments and headers have any length; 256 KiB are read at first.
TEST(TextCloud, ReadsLongCommentsAndHeaders) {
  std::string comments;
  for (int i = 0; i < 100'000; ++i) comments += "# comment\n";
  for (const std::string& before : {comments, "# " + std::string(3'000'000, 'c') + "\n"}) {
    const WholeCloud cloud = read_cloud("a.csv", before + "x,y,z\n1,2,3\n4,5,6\n");
    EXPECT_THAT(cloud[CloudField::x], ElementsAre(1, 4));
  }
  EXPECT_THAT(cloud_refusal("a.csv", comments + "x,y,z\n1,2,3\n4,b,6\n"), HasSubstr("line 100003: 'b'"));
  EXPECT_THAT(cloud_refusal("a.csv", comments), HasSubstr("has no points"));
  std::string names = "x,y,z";
  std::string row = "1,2,3";
  for (int i = 0; i < 60'000; ++i) {
    names += ",c" + std::to_string(i);
    row += ",0";
  }
  EXPECT_THAT(read_cloud("a.csv", names + "\n" + row + "\n")[CloudField::z], ElementsAre(3));
  EXPECT_THAT(cloud_refusal("a.csv", "# " + std::string(std::size_t{1} << 26U, 'c') + "\nx,y,z\n1,2,3\n"),
              HasSubstr("has no row of points in its first 64 MiB: shorten its comments or its header"));
}

TEST(TextCloud, RefusesWhatIsNotPoints) {
  const auto refusal = [](const std::string& text) { return cloud_refusal("a.csv", text); };
  EXPECT_THAT(refusal("# only\n"), HasSubstr("has no points"));
  EXPECT_THAT(refusal(std::string("x,y,z\n1,2,3\n\0", 13)), HasSubstr("is not a point cloud"));
}

}  // namespace
}  // namespace landfall
