// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cpl_conv.h>
#include <gdal_priv.h>

#include <optional>
#include <string>

#include "terrain/gdal/raster_links.h"

namespace landfall {

/// While one lives, GDAL opens no local file but those of one raster (raster_links.h) and its own resources;
/// what else it tries, because a file tells it to, fails as if it might not be read. Guards that live at the
/// same time allow what any of them allows. Python in a file and the standard input are refused at any time.
class FileGuard {
 public:
  /// With RasterLinks::followed nothing is refused. Makes GDAL ready to read (registry.h).
  FileGuard(std::string raster, RasterLinks links);
  ~FileGuard();
  FileGuard(const FileGuard&) = delete;
  FileGuard& operator=(const FileGuard&) = delete;

  /// Opens the raster; null where GDAL does not.
  [[nodiscard]] GDALDatasetUniquePtr open(unsigned flags) const;
  /// The first file that is there and was refused.
  [[nodiscard]] std::optional<std::string> refused() const;

 private:
  std::string raster_;
  std::optional<CPLConfigOptionSetter> no_sidecars_;
  int number_;
};

}  // namespace landfall
