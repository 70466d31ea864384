// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "base/core/error.h"
#include "bins.h"
#include "constants.h"
#include "formats/picture/map_picture.h"
#include "formats/picture/pixel_map.h"
#include "formats/picture/rgb_image.h"
#include "formats/picture/text_image.h"
#include "refusal.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

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

RgbImage text_image(const std::string& text) {
  RgbImage image(static_cast<std::size_t>(text_width(text)), static_cast<std::size_t>(text_height()), kWhite);
  draw_text(image, {0, 0}, text, kBlack);
  return image;
}

/// The darkness of a part of an image, in black pixels.
double ink(const RgbImage& image, std::size_t top, std::size_t bottom, std::size_t left, std::size_t right) {
  double sum = 0;
  for (std::size_t row = top; row < bottom; ++row)
    for (std::size_t col = left; col < right; ++col) sum += (255 - image.at(row, col).r) / 255.0;
  return sum;
}

TEST(Text, IsUprightProportionalAndSmooth) {
  const RgbImage image = text_image("L");
  const std::size_t middle = image.height / 2;
  EXPECT_GT(ink(image, middle, image.height, 0, image.width), 1.5 * ink(image, 0, middle, 0, image.width));
  EXPECT_GT(ink(image, 0, middle, 0, image.width / 2),
            3 * ink(image, 0, middle, image.width / 2, image.width));
  EXPECT_LT(text_width("ill"), text_width("WWW") / 2);
  EXPECT_EQ(text_width("ab"), text_width("a") + text_width("b"));
  const RgbImage round = text_image("o");
  EXPECT_TRUE(std::ranges::any_of(round.pixels, [](Rgb pixel) { return pixel.r > 60 && pixel.r < 200; }));
}

TEST(Text, HasTheLettersOfLatin1AndAQuestionMarkForOthers) {
  EXPECT_NE(text_image("\u00b1").pixels, text_image("?").pixels);
  EXPECT_EQ(text_width("\u00b11"), text_width("\u00b1") + text_width("1"));
  for (const char* other : {"\xC3", "\u2264", "\n"})
    EXPECT_EQ(text_image(other).pixels, text_image("?").pixels);
}

TEST(Text, IsCutAtTheBorder) {
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
  errors.limit = 4 * 995 / 1.1 + 1;
  EXPECT_EQ(color_range(row_of(values), errors), (std::array<double, 2>{-995, 995})) << "a limit far away";
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
  EXPECT_EQ(image.height, 3U * 17 + 40 + 600 + 2 * 17 + 32);
  EXPECT_GE(pixels_of(image, color_of(0, Colors::magnitude)), 300 * 300);
  EXPECT_GE(pixels_of(image, color_of(0.5, Colors::magnitude)), 300 * 300);
  EXPECT_GE(pixels_of(image, color_of(1, Colors::magnitude)), 300 * 300);
  EXPECT_EQ(image.at(91 + 150, 120 + 150), color_of(0, Colors::magnitude));
  EXPECT_EQ(image.at(91 + 450, 120 + 450), rgb_of(kNoValueColor));
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

/// 1 2 3 / 4 5 6 / 7 8 9, row 0 the southern.
Grid<double> numbers() {
  Grid<double> grid(GridSpec{0.5, -1, -2, 3, 3});
  for (std::size_t i = 0; i < 9; ++i) grid.values()[i] = static_cast<double>(i + 1);
  return grid;
}

TEST(PixelMap, TurnsNorthUpAndKeepsBinsThatFit) {
  const PixelMap map = reduce(numbers(), Reduction::mean, 3);
  EXPECT_EQ(map.values, (std::vector<double>{7, 8, 9, 4, 5, 6, 1, 2, 3}));
  EXPECT_EQ(map.pixel_m, 0.5);
  EXPECT_EQ(map.west_m, -1.25);
  EXPECT_EQ(map.north_m, 0.75);
}

TEST(PixelMap, TakesTheMeanOfWhatHasAValue) {
  Grid<double> grid = numbers();
  grid.at({2, 0}) = kNan;
  const PixelMap map = reduce(grid, Reduction::mean, 2);
  EXPECT_EQ(map.values, (std::vector<double>{(4 + 5 + 8) / 3.0, 7.5, 1.5, 3}));
  EXPECT_EQ(map.pixel_m, 1);
}

TEST(PixelMap, IsTheSameFromStripsInAnyOrder) {
  Grid<double> grid(GridSpec{0.25, -3, 5, 23, 17});
  for (std::size_t i = 0; i < grid.values().size(); ++i)
    grid.values()[i] = i % 7 == 3 ? kNan : static_cast<double>(i * i % 101);
  for (const Reduction reduction : {Reduction::mean, Reduction::greatest}) {
    LayerReducer reducer(grid.spec(), reduction, 6);
    for (const std::int64_t first : {16, 0, 8}) {
      const std::int64_t rows = std::min<std::int64_t>(8, 23 - first);
      Grid<double> strip(GridSpec{0.25, first - 3, 5, rows, 17});
      for (std::int64_t row = 0; row < rows; ++row)
        std::ranges::copy(grid.row(first + row), strip.row(row).begin());
      reducer.add(strip);
    }
    const PixelMap whole = reduce(grid, reduction, 6);
    const PixelMap strips = reducer.map();
    ASSERT_EQ(strips.values.size(), 6U * 5U);
    for (std::size_t i = 0; i < whole.values.size(); ++i) EXPECT_EQ(strips.values[i], whole.values[i]) << i;
  }
}

TEST(PixelMap, LosesNoFlag) {
  Grid<std::int8_t> grid(GridSpec{1, 0, 0, 5, 5}, 0);
  grid.at({3, 1}) = 16;
  EXPECT_EQ(reduce(grid, Reduction::greatest, 1).values, (std::vector<double>{16}));
  Grid<float> holes(GridSpec{1, 0, 0, 2, 2}, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(std::isnan(reduce(holes, Reduction::greatest, 1).values.front()));
}

TEST(PointMap, GathersMeansAndCounts) {
  PointMap map({0, 4, 0, 2}, 32, 1000);  // 4 of 32 points per pixel: 4 x 2 pixels of 1 m
  map.add(0.5, 1.5, 10);
  map.add(0.25, 1.25, 20);
  map.add(4, 0, 7);  // on the border
  map.add(9, -9, 9);
  const PixelMap mean = map.values();
  ASSERT_EQ(mean.rows, 2);
  ASSERT_EQ(mean.cols, 4);
  EXPECT_EQ(mean.at(0, 0), 15);
  EXPECT_TRUE(std::isnan(mean.at(0, 1)));
  EXPECT_EQ(mean.at(1, 3), 8);
  EXPECT_EQ(map.count().at(1, 3), 2);
}

TEST(PointMap, KeepsTheGreatest) {
  PointMap map({0, 1, 0, 1}, 4, 1000, Reduction::greatest);
  for (const double value : {-3, -1, -2}) map.add(0.5, 0.5, value);
  EXPECT_EQ(map.values().values, (std::vector<double>{-1}));
}

TEST(PointMap, HoldsPointsOnOneSpot) {
  PointMap map({3, 3, 5, 5}, 2, 1000);
  map.add(3, 5, 1);
  map.add(3, 5, 3);
  EXPECT_EQ(map.values().values, (std::vector<double>{2}));
}

/// A plane z = east x + north y.
PixelMap plane(double east, double north) {
  PixelMap map{5, 5, 1, 0, 5, {}};
  for (int row = 0; row < 5; ++row)
    for (int col = 0; col < 5; ++col) map.values.push_back(east * col - north * row);
  return map;
}

TEST(Relief, IsOneOnLevelGroundAndDarkAwayFromTheLight) {
  for (const double shade : hillshade(plane(0, 0))) EXPECT_EQ(shade, 1);
  // A slope of 0.4 up to the east faces west, to the light; the closed form with the normal (-0.4, 0, 1).
  const double lit = (0.4 + std::sqrt(2.0)) / std::sqrt(2.0 * 1.16);
  for (const double shade : hillshade(plane(0.4, 0))) EXPECT_NEAR(shade, lit, 1e-12);
  const double dark = (-0.4 + std::sqrt(2.0)) / std::sqrt(2.0 * 1.16);
  for (const double shade : hillshade(plane(0, 0.4))) EXPECT_NEAR(shade, dark, 1e-12);
}

TEST(Relief, LeavesOutWhatHasNoValue) {
  PixelMap map = plane(0.4, 0);
  map.values[12] = kNan;
  const double lit = (0.4 + std::sqrt(2.0)) / std::sqrt(2.0 * 1.16);
  const std::vector<double> shades = hillshade(map);
  for (std::size_t i = 0; i < 25; ++i) EXPECT_NEAR(shades[i], i == 12 ? 1 : lit, 1e-12);
}

/// Every channel takes every value; rows and columns differ in number.
RgbImage gradient() {
  RgbImage image(256, 100, {});
  for (const auto [row, col] : Bins({0, 0}, {100, 256}))
    image.set(row, col,
              {static_cast<std::uint8_t>(col), static_cast<std::uint8_t>(255 - col),
               static_cast<std::uint8_t>(2 * row)});
  return image;
}

/// The image that libpng's reader gives.
RgbImage decoded(const std::filesystem::path& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&header, path.c_str()), 0) << header.message;
  EXPECT_EQ(header.format, PNG_FORMAT_RGB) << "as it is stored";
  RgbImage image(header.width, header.height, {});
  EXPECT_NE(png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr), 0) << header.message;
  return image;
}

/// The types of the chunks, without repetitions of IDAT.
std::vector<std::string> chunks(const std::string& bytes) {
  std::vector<std::string> types;
  for (std::size_t at = 8; at + 8 <= bytes.size();) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i) size = size * 256 + static_cast<unsigned char>(bytes[at + i]);
    const std::string type = bytes.substr(at + 4, 4);
    if (types.empty() || types.back() != type) types.push_back(type);
    at += 12 + size;
  }
  return types;
}

TEST(WritePng, KeepsEveryPixel) {
  const TemporaryFolder folder;
  const RgbImage image = gradient();
  write_png({folder / "a.png", false}, image);
  const RgbImage read = decoded(folder / "a.png");
  ASSERT_EQ(read.width, image.width);
  ASSERT_EQ(read.height, image.height);
  EXPECT_EQ(read.pixels, image.pixels);
}

TEST(WritePng, GivesEqualBytesForEqualImagesAndNoTimeOrText) {
  const TemporaryFolder folder;
  write_png({folder / "a.png", false}, gradient());
  write_png({folder / "b.png", false, 9}, gradient());
  EXPECT_EQ(read_file(folder / "a.png"), read_file(folder / "b.png"));
  EXPECT_THAT(chunks(read_file(folder / "a.png")), ElementsAre("IHDR", "sRGB", "IDAT", "IEND"));
}

TEST(WritePng, ReplacesOnlyWhatMayBeReplaced) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.png") << "mine";
  EXPECT_THAT(refusal([&] { write_png({folder / "a.png", false}, gradient()); }), HasSubstr("a.png exists"));
  EXPECT_EQ(read_file(folder / "a.png"), "mine");
  write_png({folder / "a.png", true}, gradient());
  EXPECT_EQ(decoded(folder / "a.png").pixels, gradient().pixels);
}

TEST(WritePng, NamesTheOutputThatCannotBeEncodedAndLeavesNothing) {
  const TemporaryFolder folder;
  EXPECT_THAT(
      [&] {
        write_png({folder / "a.png", false}, RgbImage(0, 0, {}));
      },
      ThrowsMessage<IoError>(HasSubstr((folder / "a.png").string() + ": encoding the PNG failed: ")));
  EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace landfall
