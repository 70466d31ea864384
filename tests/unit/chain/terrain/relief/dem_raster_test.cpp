// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/dem_raster.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/core/error.h"
#include "bins.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

using enum Interpolation;

template <class F>
DemSamples sampled(const RasterSize& size, const F& f) {
  DemSamples samples{size, {}};
  for (const auto [r, c] : bins_of(size))
    samples.values.push_back(f(static_cast<double>(c), static_cast<double>(r)));
  return samples;
}

DemSamples counting() {
  return sampled({3, 4}, [](double c, double r) { return 10 * r + c; });
}

TEST(Nearest, PixelsAreHalfOpenAndReachTheirEdges) {
  const DemSamples s = counting();
  EXPECT_EQ(interpolate(s, nearest, {1.49, 0}), 1);
  EXPECT_EQ(interpolate(s, nearest, {1.5, 0}), 2);
  EXPECT_EQ(interpolate(s, nearest, {0, 1.5}), 20);
  EXPECT_EQ(interpolate(s, nearest, {-0.5, -0.5}), 0);
  EXPECT_EQ(interpolate(s, nearest, {3.5, 2.5}), 23);
  EXPECT_TRUE(std::isnan(interpolate(s, nearest, {3.51, 0})));
  EXPECT_TRUE(std::isnan(interpolate(s, nearest, {0, -0.51})));
}

TEST(Bilinear, HandComputed) {
  const DemSamples s{{2, 2}, {0, 1, 2, 7}};
  EXPECT_EQ(interpolate(s, bilinear, {0.5, 0.5}), 2.5);
  EXPECT_EQ(interpolate(s, bilinear, {0.25, 0}), 0.25);
  EXPECT_EQ(interpolate(s, bilinear, {1, 1}), 7);
  EXPECT_TRUE(std::isnan(interpolate(s, bilinear, {1.01, 0})));
  EXPECT_TRUE(std::isnan(interpolate(s, bilinear, {0, kNan})));
}

TEST(Bilinear, ReproducesBilinearFunctions) {
  const auto f = [](double c, double r) { return 3 + 0.5 * c - 2 * r + 0.25 * c * r; };
  const DemSamples s = sampled({6, 7}, f);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const PixelPosition p{6 * unit(random), 5 * unit(random)};
    EXPECT_NEAR(interpolate(s, bilinear, p), f(p.col, p.row), 1e-13);
  }
}

// Keys' kernel with a = -1/2 at the middle of a cell: weights -1/16, 9/16, 9/16, -1/16.
TEST(Bicubic, HandComputed) {
  const DemSamples s{{2, 4}, {1, 2, 4, 8, 1, 2, 4, 8}};
  EXPECT_EQ(interpolate(s, bicubic, {1.5, 0}), (-1 + 18 + 36 - 8) / 16.0);
  EXPECT_EQ(interpolate(s, bicubic, {0.5, 0}), (-1 + 9 + 18 - 4) / 16.0);  // the border repeats
  EXPECT_EQ(interpolate(s, bicubic, {3, 1}), 8);
}

TEST(Bicubic, ReproducesQuadraticsAwayFromTheBorder) {
  const auto f = [](double c, double r) { return (1 - 0.7 * c + 0.3 * c * c) * (2 + 0.5 * r - 0.2 * r * r); };
  const DemSamples s = sampled({9, 8}, f);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const PixelPosition p{1 + 5 * unit(random), 1 + 6 * unit(random)};
    EXPECT_NEAR(interpolate(s, bicubic, p), f(p.col, p.row), 1e-11);
  }
}

TEST(Holes, SpoilOnlyWhatTheyContributeTo) {
  DemSamples s = sampled({5, 5}, [](double c, double) { return c; });
  s.values[2 * 5 + 2] = kNan;  // the middle
  EXPECT_TRUE(std::isnan(interpolate(s, nearest, {2.4, 2})));
  EXPECT_EQ(interpolate(s, nearest, {1.4, 2}), 1);
  EXPECT_TRUE(std::isnan(interpolate(s, bilinear, {1.5, 1.5})));
  EXPECT_EQ(interpolate(s, bilinear, {1.5, 1}), 1.5);  // on the row above: the hole's weight is 0
  EXPECT_EQ(interpolate(s, bilinear, {1, 2}), 1);
}

// Two cells away from a hole the 4 x 4 ring meets it: bilinear there, so that the hole stays one cell wide.
TEST(Holes, DoNotGrowUnderBicubic) {
  DemSamples s = sampled({6, 6}, [](double c, double) { return c * c; });
  s.values[2 * 6 + 4] = kNan;
  EXPECT_NEAR(interpolate(s, bicubic, {2.5, 2.5}), 6.5, 1e-14);   // linear between 4 and 9
  EXPECT_NEAR(interpolate(s, bicubic, {1.5, 2.5}), 2.25, 1e-14);  // cubic: out of its reach
  EXPECT_TRUE(std::isnan(interpolate(s, bicubic, {3.5, 2.5})));
  for (double row = 1; row <= 4; row += 0.125)
    for (double col = 1; col <= 4; col += 0.125)
      EXPECT_EQ(std::isnan(interpolate(s, bicubic, {col, row})),
                std::isnan(interpolate(s, bilinear, {col, row})))
          << col << ' ' << row;
}

// A lattice whose georeference is rounded: each node is the sample, also beside a hole.
TEST(Holes, DoNotReachTheNodesBesideThem) {
  DemSamples s = sampled({5, 5}, [](double c, double r) { return 10 * r + c / 3; });
  s.values[2 * 5 + 2] = kNan;
  for (const Interpolation method : {bilinear, bicubic})
    for (const double off : {-9e-7, -1e-10, 1e-10, 9e-7})
      for (double row = 0; row < 5; ++row)
        for (double col = 0; col < 5; ++col) {
          const double z = interpolate(s, method, {col + off, row - off});
          const double node = s.at(static_cast<std::int64_t>(row), static_cast<std::int64_t>(col));
          EXPECT_TRUE(z == node || (std::isnan(z) && std::isnan(node))) << col << ' ' << row;
        }
  EXPECT_TRUE(std::isnan(interpolate(s, bilinear, {1 + 2e-6, 2})));
}

TEST(Inside, AllowsForRoundingOnTheBorder) {
  const DemSamples s = counting();
  EXPECT_EQ(interpolate(s, bilinear, {3 + 1e-9, -1e-9}), 3);
  EXPECT_FALSE(inside(s.size, bicubic, {3.00001, 0}));
  EXPECT_TRUE(inside(s.size, nearest, {3.49, 0}));
  EXPECT_FALSE(inside(s.size, nearest, {kNan, 0}));
}

SiteMapping metres(const PixelPosition& center) { return {GeoTransform({0, 1, 0, 0, 0, -1}), center, 1}; }

TEST(RequireSiteInside, NamesSizeAndFit) {
  using testing::AllOf;
  using testing::HasSubstr;
  const GridSpec site = GridSpec::centered(5, 0.5);
  EXPECT_NO_THROW(require_site_inside(metres({5, 5}), {11, 11}, bilinear, site, "a.tif"));
  EXPECT_NO_THROW(require_site_inside(metres({5, 5}), {11, 11}, bicubic, site, "a.tif"));
  EXPECT_NO_THROW(require_site_inside(metres({4.5, 4.5}), {10, 10}, nearest, site, "a.tif"));
  const auto refusal = [&](const PixelPosition& center, const RasterSize& size, Interpolation method) {
    return landfall::refusal<FormatError>(
        [&] { require_site_inside(metres(center), size, method, site, "a.tif"); });
  };
  EXPECT_EQ(
      refusal({4.5, 4.5}, {10, 12}, bilinear),
      "a.tif: the site, -5 .. 5 m, does not lie inside the raster of 12 x 10 pixels; around this centre a "
      "half_width_m of 4.5 would fit");
  EXPECT_THAT(refusal({4.4, 4.5}, {10, 10}, nearest), HasSubstr("half_width_m of 4.5 "));
  EXPECT_THAT(refusal({-1, 4}, {20, 20}, bilinear), HasSubstr("centre is outside"));
  EXPECT_THAT(refusal({0, 4}, {20, 20}, bilinear), HasSubstr("not one cell of 0.5 m fits"));
}

}  // namespace
}  // namespace landfall
