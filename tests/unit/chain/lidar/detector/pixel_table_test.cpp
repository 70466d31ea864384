// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/detector/pixel_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <map>
#include <string>

#include "base/core/error.h"
#include "refusal.h"

namespace landfall {
namespace {

using Rows = std::vector<std::array<double, 4>>;

NumberTable table_of(const Rows& rows) {
  std::map<std::string, std::vector<double>> columns{{"row", {}}, {"column", {}}, {"u", {}}, {"v", {}}};
  for (const auto& [row, column, u, v] : rows) {
    columns["row"].push_back(row);
    columns["column"].push_back(column);
    columns["u"].push_back(u);
    columns["v"].push_back(v);
  }
  return {"pixels.csv", std::move(columns)};
}

void expect_refused(const Rows& table, const std::string& words) {
  EXPECT_THAT(refusal<FormatError>([&] { return pixel_points(table_of(table), 2, 2); }),
              testing::StartsWith("pixels.csv: " + words));
}

const Rows kWhole = {{1, 1, 4, 5}, {0, 0, -1, -2}, {0, 1, 2, 3}, {1, 0, 6, 7}};

TEST(PixelTable, AnyOrderOfRows) {
  EXPECT_EQ(pixel_points(table_of(kWhole), 2, 2),
            (std::vector<ImagePoint>{{-1, -2}, {2, 3}, {6, 7}, {4, 5}}));
}

TEST(PixelTable, LineArrays) {
  EXPECT_EQ(pixel_points(table_of({{0, 1, 1, 0}, {0, 0, 2, 0}, {0, 2, 3, 0}}), 1, 3),
            (std::vector<ImagePoint>{{2, 0}, {1, 0}, {3, 0}}));
}

TEST(PixelTable, EveryPixelExactlyOnce) {
  expect_refused({kWhole.begin(), kWhole.begin() + 3}, "pixel (row 1, column 0) has no row");
  expect_refused({}, "pixel (row 0, column 0) has no row");
  Rows twice = kWhole;
  twice.push_back(kWhole[2]);
  expect_refused(twice, "row 5: pixel (row 0, column 1) has a row already");
}

TEST(PixelTable, OnlyPixelsOfTheDetector) {
  const auto with = [](double row, double column) {
    Rows table = kWhole;
    table[1][0] = row;
    table[1][1] = column;
    return table;
  };
  expect_refused(with(2, 0), "row 2: row 2 is not one of 0..1");
  expect_refused(with(-1, 0), "row 2: row -1 is not one of 0..1");
  expect_refused(with(0.5, 0), "row 2: row 0.5 is not");
  expect_refused(with(0, 2), "row 2: column 2 is not one of 0..1");
  expect_refused(with(0, std::numeric_limits<double>::quiet_NaN()), "row 2: column nan is not");
}

TEST(PixelTable, PlacesMustBeFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Rows table = kWhole;
    table[2][2] = bad;
    expect_refused(table, "row 3: u and v must be finite");
    table[2] = {0, 1, 0, bad};
    expect_refused(table, "row 3: u and v must be finite");
  }
}

TEST(PixelOffsets, OneRowPerPixelInAnyOrder) {
  const auto offsets_of = [](std::vector<double> rows, std::vector<double> offsets) {
    return pixel_offsets_m(
        {"offsets.csv", {{"row", std::move(rows)}, {"column", {1, 0}}, {"offset_m", std::move(offsets)}}}, 1,
        2);
  };
  EXPECT_EQ(offsets_of({0, 0}, {0.02, -0.01}), (std::vector<double>{-0.01, 0.02}));
  EXPECT_THROW(static_cast<void>(offsets_of({0, 1}, {0.02, -0.01})), FormatError);
  EXPECT_THROW(static_cast<void>(offsets_of({0, 0}, {0.02, std::numeric_limits<double>::infinity()})),
               FormatError);
}

}  // namespace
}  // namespace landfall
