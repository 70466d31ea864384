// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/picture/map_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "constants.h"
#include "formats/picture/bitmap_font.h"

namespace landfall {
namespace {

constexpr Rgb kWhite = {255, 255, 255};
constexpr Rgb kBlack = {0, 0, 0};

constexpr std::array kAllColors = {Colors::elevation, Colors::error, Colors::count, Colors::magnitude};

double light(Rgb c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

int difference(Rgb a, Rgb b) { return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b); }

TEST(Colors, RunFromEndToEndAndStayThere) {
  EXPECT_EQ(color_of(0, Colors::elevation), (Rgb{0, 34, 78}));
  EXPECT_EQ(color_of(1, Colors::elevation), (Rgb{254, 232, 56}));
  EXPECT_EQ(color_of(7, Colors::magnitude), color_of(1, Colors::magnitude));
  EXPECT_EQ(color_of(-7, Colors::error), color_of(0, Colors::error));
  EXPECT_EQ(color_of(0.5, Colors::error), (Rgb{247, 246, 246}));
}

TEST(Colors, BecomeSteadilyLighterOrDarkerWithTheValue) {
  for (int i = 1; i <= 100; ++i) {
    const auto step = [i](Colors colors) {
      return light(color_of(i / 100.0, colors)) - light(color_of((i - 1) / 100.0, colors));
    };
    EXPECT_GE(step(Colors::elevation), 0);
    EXPECT_GE(step(Colors::magnitude), 0);
    EXPECT_LE(step(Colors::count), 0);
  }
}

TEST(Colors, NoValueAndMarksAreNoneOfThem) {
  for (const Colors colors : kAllColors)
    for (int i = 0; i <= 100; ++i) {
      EXPECT_GE(difference(color_of(i / 100.0, colors), rgb_of(kNoValueColor)), 60) << name_of(colors);
      EXPECT_GE(difference(color_of(i / 100.0, colors), rgb_of(kMarkColor)), 150) << name_of(colors);
    }
}

/// The dots of a text, row by row.
std::string dots(const std::string& text) {
  RgbImage image(static_cast<std::size_t>(text_width(text)), kTextHeight, kWhite);
  draw_text(image, {0, 0}, text, kBlack);
  std::string result;
  for (std::size_t row = 0; row < image.height; row += kDot) {
    for (std::size_t col = 0; col < image.width; col += kDot)
      result += image.at(row, col) == kBlack ? '#' : '.';
    result += '\n';
  }
  return result;
}

TEST(BitmapFont, DrawsLettersUpright) {
  EXPECT_EQ(dots("Fy"),
            "#####......\n#..........\n#.....#...#\n####..#...#\n#.....#...#\n#......####\n#.........#\n....."
            "..###.\n");
}

TEST(BitmapFont, DrawsAQuestionMarkForWhatItDoesNotKnow) { EXPECT_EQ(dots("\xC3"), dots("?")); }

TEST(BitmapFont, IsCutAtTheBorder) {
  RgbImage image(3, 3, kWhite);
  draw_text(image, {-5, -5}, "WWW", kBlack);
  draw_text(image, {2, 2}, "WWW", kBlack);
  EXPECT_EQ(image.pixels.size(), 9U);
}

TEST(Ticks, AreRoundNumbersWithin) {
  EXPECT_EQ(ticks(-10.05, 10.05, 5), (std::vector<double>{-10, -5, 0, 5, 10}));
  EXPECT_EQ(ticks(0, 0.3, 3), (std::vector<double>{0, 0.1, 0.2, 0.3}));
  EXPECT_EQ(ticks(1234.1, 1234.9, 4), (std::vector<double>{1234.2, 1234.4, 1234.6, 1234.8}));
  EXPECT_EQ(ticks(0, 2e6, 2), (std::vector<double>{0, 1e6, 2e6}));
  // A range that rounding has closed, or that no step divides, has none.
  EXPECT_EQ(ticks(1e308, 1e308, 3), (std::vector<double>{}));
  EXPECT_EQ(ticks(-1.7e308, 1.7e308, 3), (std::vector<double>{}));
  EXPECT_LE(ticks(1e17, 1e17 + 64, 3).size(), 40U);
}

PixelMap row_of(std::vector<double> values) {
  PixelMap map{1, static_cast<std::int64_t>(values.size()), 1, 0, 1, {}};
  map.values = std::move(values);
  return map;
}

TEST(ColorRange, IsThatOfTheFiniteValues) {
  MapStyle whole{"z", "m"};
  whole.cut = false;
  EXPECT_EQ(color_range(row_of({3, kNan, -1, 2}), whole), (std::array<double, 2>{-1, 3}));
  EXPECT_EQ(color_range(row_of({kNan}), whole), (std::array<double, 2>{0, 1}));
  EXPECT_EQ(color_range(row_of({4, 4}), whole), (std::array<double, 2>{2, 6}));
  whole.colors = Colors::error;
  EXPECT_EQ(color_range(row_of({3, -5, 0}), whole), (std::array<double, 2>{-5, 5}));
}

TEST(ColorRange, OfErrorsEndsAtAQuantileOfTheMagnitudesAndHoldsTheLimit) {
  std::vector<double> values(1001, 0);
  for (int i = 0; i <= 1000; ++i) values[static_cast<std::size_t>(i)] = i % 2 == 0 ? i : -i;
  MapStyle errors{"e_z", "m", Colors::error};
  EXPECT_EQ(color_range(row_of(values), errors), (std::array<double, 2>{-995, 995}));
  errors.limit = 2000;
  EXPECT_EQ(color_range(row_of(values), errors), (std::array<double, 2>{-1.1 * 2000, 1.1 * 2000}));
  MapStyle relative{"rel_z", "m"};
  relative.from_zero = true;
  relative.limit = 10;
  EXPECT_EQ(color_range(row_of(values), relative), (std::array<double, 2>{0, 995}));
}

TEST(ColorRange, LeavesOutliersOut) {
  std::vector<double> values(1001, 0);
  for (int i = 0; i <= 1000; ++i) values[static_cast<std::size_t>(i)] = i;
  values[0] = -1e9;
  values[1000] = 1e9;
  EXPECT_EQ(color_range(row_of(values), {"z", "m"}), (std::array<double, 2>{5, 995}));
  values[0] = -500;
  values[1000] = 1400;
  EXPECT_EQ(color_range(row_of(values), {"z", "m"}), (std::array<double, 2>{-500, 1400}));
}

/// How often a colour stands in a picture.
std::int64_t pixels_of(const RgbImage& image, Rgb color) {
  return std::count(image.pixels.begin(), image.pixels.end(), color);
}

TEST(MapPicture, ShowsEveryPixelInItsColourEnlarged) {
  PixelMap map{2, 2, 1, 0, 2, {0, 1, 2, kNan}};
  MapStyle style{"z", "m"};
  style.cut = false;
  const RgbImage image = map_picture(map, style);
  EXPECT_EQ(image.height, 3U * 16 + 40 + 600 + 2 * 16 + 32);
  EXPECT_GE(pixels_of(image, color_of(0, Colors::magnitude)), 300 * 300);
  EXPECT_GE(pixels_of(image, color_of(0.5, Colors::magnitude)), 300 * 300);
  EXPECT_GE(pixels_of(image, color_of(1, Colors::magnitude)), 300 * 300);
  EXPECT_EQ(image.at(88 + 150, 120 + 150), color_of(0, Colors::magnitude));
  EXPECT_EQ(image.at(88 + 450, 120 + 450), rgb_of(kNoValueColor));
}

TEST(MapPicture, MarksTheLimitOnItsScale) {
  MapStyle style{"e_z", "m", Colors::error};
  const auto ink = [&style] { return pixels_of(map_picture(row_of({-1, 1}), style), {30, 30, 30}); };
  const std::int64_t without = ink();
  style.limit = 0.5;
  EXPECT_GE(ink(), without + 2 * 3 * 22);  // two lines of three pixels across the bar
}

TEST(MapPicture, HasRoomForAMapWithoutAnyValue) {
  const RgbImage image = map_picture(row_of(std::vector<double>(1000, kNan)), {"z", ""});
  EXPECT_EQ(image.width, 120U + 1000 + 190);
  EXPECT_GT(image.height, 240U);
}

}  // namespace
}  // namespace landfall
