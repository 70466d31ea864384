// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/site_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>


#include "refusal.h"

namespace landfall {
namespace {

using enum Interpolation;

/// 21 x 31 pixels of 2 m, the site around the pixel (`col`, 15).
struct Raster {
  explicit Raster(double col) : mapping(GeoTransform({0, 2, 0, 62, 0, -2}), {col, 15}, 1) {}
  [[nodiscard]] SiteSize fit(Interpolation method, const SiteRequest& request) const {
    return fit_site({mapping, {31, 21}, 2}, method, request, "a.tif");
  }
  SiteMapping mapping;
};

// The nearest pixel reaches half a pixel beyond the outermost centres, the others end there.
TEST(FitSite, IsTheLargestSquareAroundTheCentre) {
  EXPECT_EQ(Raster(10).fit(bilinear, {}), (SiteSize{20, 2}));
  EXPECT_EQ(Raster(10).fit(bicubic, {{}, 1}), (SiteSize{20, 1}));
  EXPECT_EQ(Raster(10).fit(nearest, {{}, 1}), (SiteSize{21, 1}));
  EXPECT_EQ(Raster(10).fit(bilinear, {{}, 3}), (SiteSize{18, 3}));
  EXPECT_EQ(Raster(4).fit(bilinear, {}), (SiteSize{8, 2}));
}

TEST(FitSite, ResolutionDividesAGivenHalfWidth) {
  EXPECT_EQ(Raster(10).fit(bilinear, {10, {}}), (SiteSize{10, 2}));
  EXPECT_EQ(Raster(10).fit(bilinear, {9, {}}), (SiteSize{9, 1.8}));
  EXPECT_EQ(Raster(10).fit(bilinear, {1, {}}), (SiteSize{1, 1}));
  EXPECT_EQ(Raster(10).fit(bilinear, {7, 0.5}), (SiteSize{7, 0.5}));
  EXPECT_EQ(Raster(10).fit(bilinear, {1000, 10}), (SiteSize{1000, 10}));  // refused where it is imported
}

TEST(FitSite, SaysWhatIsMissing) {
  const auto refusal = [](double col, const SiteRequest& request) {
    return kind_and_refusal([&] { return Raster(col).fit(bilinear, request); });
  };
  EXPECT_THAT(refusal(10, {{}, 0.001}), ::testing::AllOf(::testing::StartsWith("usage: a.tif: "),
                                                         ::testing::HasSubstr("half_width_m")));
  EXPECT_EQ(refusal(10, {{}, 20.0 / 4095}), "accepted");
  EXPECT_THAT(refusal(0, {}), ::testing::AllOf(::testing::StartsWith("format: a.tif: "),
                                               ::testing::HasSubstr("another center")));
  EXPECT_THAT(refusal(40, {}), ::testing::StartsWith("format: a.tif: "));
}

}  // namespace
}  // namespace landfall
