// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/gdal/png_writer.h"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include <cstddef>
#include <cstdint>

#include "base/error.h"
#include "terrain/gdal/gdal_errors.h"
#include "terrain/gdal/registry.h"

namespace landfall {
namespace {

GDALDriver& driver_named(const char* name) {
  GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName(name);
  if (driver == nullptr) throw IoError(std::string("this GDAL has no driver ") + name);
  return *driver;
}

/// A file in memory, so that writing to the disk is not GDAL's, which would not say why it failed.
class MemoryFile {
 public:
  /// One per picture that is being made.
  explicit MemoryFile(const RgbImage& image)
      : path_("/vsimem/landfall-" + std::to_string(reinterpret_cast<std::uintptr_t>(&image)) + ".png") {}
  ~MemoryFile() { VSIUnlink(path_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string bytes() const {
    vsi_l_offset size = 0;
    const GByte* const data = VSIGetMemFileBuffer(path_.c_str(), &size, FALSE);
    return data == nullptr ? "" : std::string(data, data + size);
  }

 private:
  std::string path_;
};

}  // namespace

std::string png_bytes(const RgbImage& image) {
  static_assert(sizeof(Rgb) == 3 && offsetof(Rgb, g) == 1 && offsetof(Rgb, b) == 2);
  prepare_gdal_to_write();
  GdalErrors errors;
  CPLConfigOptionSetter no_sidecar("GDAL_PAM_ENABLED", "NO", false);
  const int width = static_cast<int>(image.width);
  const int height = static_cast<int>(image.height);
  GDALDatasetUniquePtr memory(driver_named("MEM").Create("", width, height, 3, GDT_Byte, nullptr));
  // GDAL takes no const memory, also where it only reads.
  auto* const pixels = const_cast<Rgb*>(image.pixels.data());
  const bool copied =
      memory != nullptr && memory->RasterIO(GF_Write, 0, 0, width, height, pixels, width, height, GDT_Byte, 3,
                                            nullptr, 3, GSpacing{3} * width, 1, nullptr) == CE_None;
  const MemoryFile file(image);
  GDALDatasetUniquePtr written(copied ? driver_named("PNG").CreateCopy(file.path().c_str(), memory.get(),
                                                                       FALSE, nullptr, nullptr, nullptr)
                                      : nullptr);
  const bool made = written != nullptr;
  written.reset();  // what is still in buffers is written now
  if (!made || errors.any()) throw IoError("making a PNG failed: " + errors.reason());
  return file.bytes();
}

}  // namespace landfall
