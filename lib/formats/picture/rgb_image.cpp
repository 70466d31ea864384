// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/picture/rgb_image.h"

#include <png.h>

#include <string>

#include "base/core/error.h"

namespace landfall {

void write_png(const OutputOptions& options, const RgbImage& image) {
  static_assert(sizeof(Rgb) == 3 && offsetof(Rgb, g) == 1 && offsetof(Rgb, b) == 2);
  OutputPath output(options.path, options.overwrite);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(header), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0)
    throw IoError("output " + options.path.string() + ": encoding the PNG failed: " + header.message);
  bytes.resize(size);
  write_text(output, bytes);
  output.commit();
}

}  // namespace landfall
