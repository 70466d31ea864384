// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/exports/quick_look.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "formats/picture/text_image.h"
#include "store/files/grid_file.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

constexpr Rgb kSafe = {0xcf, 0xe4, 0xf2};
constexpr Rgb kHazard = {0xe6, 0x9f, 0x00};
constexpr Rgb kMissed = {0xff, 0x00, 0xff};
constexpr Rgb kAlarm = {0x00, 0x72, 0xb2};
constexpr Rgb kUnknown = {0x8c, 0x8c, 0x8c};
constexpr Rgb kNoValue = {0xc8, 0xc8, 0xc8};

/// Values of the layer `outcome` from the worst to the best, and their colours.
constexpr std::array<std::int8_t, 5> kOutcomes = {2, 0, 3, 4, 1};
constexpr std::array<Rgb, 5> kOutcomeColors = {kMissed, kHazard, kAlarm, kUnknown, kSafe};
/// Those of `safe`.
constexpr std::array<std::int8_t, 3> kSafeties = {0, 2, 1};
constexpr std::array<Rgb, 3> kSafetyColors = {kHazard, kUnknown, kSafe};

// The upper left pixel of the map in the picture (lib/formats/picture/map_picture.cpp).
const auto kTop = static_cast<std::size_t>(3 * text_height() + 40);
constexpr std::size_t kLeft = 120;

/// The picture of a file that has this layer only.
RgbImage picture_of(const std::string& kind, const std::string& name, const Grid<std::int8_t>& values) {
  const TemporaryFolder folder;
  LandfallFileWriter file({folder / "map.h5", true, 1}, kind, {.tool = "hazard-map"});
  GridLayerWriter(file, values.spec(), "").write(name, values, {"1", "a layer"});
  file.commit();
  return quick_look(folder / "map.h5", name);
}

/// Two equal rows of bins, because no file has fewer.
template <std::size_t N>
Grid<std::int8_t> rows_of(const std::array<std::int8_t, N>& values) {
  Grid<std::int8_t> grid({1, 0, 0, 2, static_cast<std::int64_t>(N)});
  for (const std::int64_t row : {0, 1}) std::copy(values.begin(), values.end(), grid.row(row).begin());
  return grid;
}

/// The colours of the upper row of bins.
std::vector<Rgb> colors_of(const RgbImage& image, std::size_t count) {
  std::vector<Rgb> colors;
  const std::size_t zoom = 600 / count;
  for (std::size_t i = 0; i < count; ++i)
    colors.push_back(image.at(kTop + zoom / 2, kLeft + i * zoom + zoom / 2));
  return colors;
}

TEST(QuickLook, DrawsOutcomesInTheColoursOfTheirClasses) {
  EXPECT_EQ(colors_of(picture_of("hazards", "outcome", rows_of(kOutcomes)), 5),
            std::vector<Rgb>(kOutcomeColors.begin(), kOutcomeColors.end()));
}

TEST(QuickLook, DrawsSafetyInTheColoursOfItsClasses) {
  for (const char* const name : {"safe", "safe_true"})
    EXPECT_EQ(colors_of(picture_of("hazards", name, rows_of(kSafeties)), 3),
              std::vector<Rgb>(kSafetyColors.begin(), kSafetyColors.end()))
        << name;
}

/// For each two classes, a block of 2 x 2 bins, of which one has the worse class, each time another.
template <std::size_t N>
void expect_the_worst(const std::string& layer, const std::array<std::int8_t, N>& values,
                      const std::array<Rgb, N>& colors) {
  Grid<std::int8_t> grid({1, 0, 0, 2, 2200}, values.back());  // twice the largest picture
  std::vector<Rgb> expected;
  for (std::size_t worse = 0; worse < N; ++worse)
    for (std::size_t better = worse; better < N; ++better) {
      const auto block = static_cast<std::int64_t>(expected.size());
      for (std::int64_t i = 0; i < 4; ++i)
        grid.at({i / 2, 2 * block + i % 2}) = values.at(i == block % 4 ? worse : better);
      expected.push_back(colors.at(worse));
    }
  const RgbImage image = picture_of("hazards", layer, grid);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(image.at(kTop, kLeft + i), expected[i]) << i;
  EXPECT_EQ(image.at(kTop, kLeft + expected.size()), colors.back());
}

TEST(QuickLook, ShowsTheWorstClassOfAPixel) {
  expect_the_worst("outcome", kOutcomes, kOutcomeColors);
  expect_the_worst("safe", kSafeties, kSafetyColors);
}

/// The colours of the legend, from above, in the middle of its column of colours.
std::vector<Rgb> legend_of(const RgbImage& image) {
  std::vector<Rgb> found;
  constexpr Rgb kPaper = {255, 255, 255};
  constexpr Rgb kInk = {30, 30, 30};
  for (std::size_t row = kTop; row < image.height; ++row) {
    const Rgb color = image.at(row, kLeft + 600 + 3 * 8 + 11);
    if (color != kPaper && color != kInk && (found.empty() || found.back() != color)) found.push_back(color);
  }
  return found;
}

TEST(QuickLook, ListsTheClassesFromTheWorstToTheBest) {
  const RgbImage outcome = picture_of("hazards", "outcome", rows_of(kOutcomes));
  EXPECT_EQ(legend_of(outcome), std::vector<Rgb>(kOutcomeColors.begin(), kOutcomeColors.end()));
  const RgbImage safe = picture_of("hazards", "safe", rows_of(kSafeties));
  EXPECT_EQ(legend_of(safe), std::vector<Rgb>(kSafetyColors.begin(), kSafetyColors.end()));
  // The longest name, "missed hazard", ends inside the picture.
  for (std::size_t row = 0; row < outcome.height; ++row)
    EXPECT_EQ(outcome.at(row, outcome.width - 1), (Rgb{255, 255, 255}));
}

TEST(QuickLook, HasNoColourForAValueThatIsNoClass) {
  const RgbImage image = picture_of("hazards", "safe", rows_of<3>({1, 3, -1}));
  EXPECT_EQ(colors_of(image, 3), (std::vector<Rgb>{kSafe, kNoValue, kNoValue}));
  EXPECT_EQ(legend_of(image), (std::vector<Rgb>{kHazard, kUnknown, kSafe, kNoValue}));
}

TEST(QuickLook, DrawsTheFlagsOfOtherFilesAsNumbers) {
  EXPECT_EQ(colors_of(picture_of("dem", "safe", rows_of(kSafeties)), 3),
            (std::vector<Rgb>{color_of(0, Colors::magnitude), color_of(1, Colors::magnitude),
                              color_of(0.5, Colors::magnitude)}));
}

}  // namespace
}  // namespace landfall
