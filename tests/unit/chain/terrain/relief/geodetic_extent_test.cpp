// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/geodetic_extent.h"

#include <gtest/gtest.h>

#include <vector>

#include "constants.h"

namespace landfall {
namespace {

/// The longitudes from low to high across the seam, degrees; empty: none lie across it.
std::vector<double> across(const std::vector<double>& longitudes_deg) {
  GeodeticExtentSearch search;
  for (const double lon : longitudes_deg) search.add({lon * kDegree, 0.1});
  const auto extent = search.across_seam();
  if (!extent) return {};
  EXPECT_EQ(extent->low.lat_rad, 0.1);
  return {extent->low.lon_rad / kDegree, extent->high.lon_rad / kDegree};
}

void expect_across(const std::vector<double>& longitudes_deg, double low, double high) {
  const std::vector<double> found = across(longitudes_deg);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0], low, 1e-12);
  EXPECT_NEAR(found[1], high, 1e-12);
}

TEST(GeodeticExtent, LiesAcrossTheSeamWhereTheWidestGapIsAnother) {
  expect_across({179.9999, -179.9998, 180, 179.99995}, 179.9999, 180.0002);
  expect_across({359.9, 0.2, 0, 360}, 359.9, 360.2);
  expect_across({-100, 100}, 100, 260);
  expect_across({10, 120, -150}, 10, 210);
}

TEST(GeodeticExtent, LiesOnOneSideOtherwise) {
  for (const std::vector<double>& longitudes : {std::vector{12.0, 13.0},
                                                {-0.1, 0.1},
                                                {0.0, 120.0},
                                                {179.0, 180.0},
                                                {-180.0, -179.0},
                                                {400.0, 401.0},
                                                {5.0}})
    EXPECT_TRUE(across(longitudes).empty());
  std::vector<double> around;
  for (int i = 0; i < 3600; ++i) around.push_back(-180 + i / 10.0);
  EXPECT_TRUE(across(around).empty()) << "points around the body";
  EXPECT_TRUE(across({}).empty());
  EXPECT_TRUE(across({kNan}).empty());
}

}  // namespace
}  // namespace landfall
