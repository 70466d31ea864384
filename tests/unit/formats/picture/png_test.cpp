// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/picture/rgb_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <vector>

#include "base/core/error.h"
#include "refusal.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Every channel takes every value; rows and columns differ in number.
RgbImage gradient() {
  RgbImage image(256, 100, {});
  for (std::int64_t row = 0; row < 100; ++row)
    for (std::int64_t col = 0; col < 256; ++col)
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
