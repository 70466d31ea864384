// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cpl_conv.h>
#include <gdal_priv.h>

#include <optional>
#include <string>

#include "chain/terrain/relief/dem_raster.h"

namespace landfall {

/// While a guard exists, GDAL opens only the local files of one raster (dem_raster.h) and its own
/// resources; other files that a file refers to fail to open as if they were unreadable. Guards that exist at
/// the same time allow what any of them allows. Python in a file and the standard input are always refused.
class FileGuard {
 public:
  /// With RasterLinks::followed nothing is refused. Prepares GDAL for reading (registry.h).
  FileGuard(std::string raster, RasterLinks links);
  ~FileGuard();
  FileGuard(const FileGuard&) = delete;
  FileGuard& operator=(const FileGuard&) = delete;

  /// Opens the raster; null if GDAL cannot open it.
  [[nodiscard]] GDALDatasetUniquePtr open(unsigned flags) const;
  /// Opens a file of the raster by the multidimensional interface of a driver; null if it cannot.
  [[nodiscard]] GDALDatasetUniquePtr open_arrays(const std::string& file, const std::string& driver) const;
  /// The first existing file that was refused.
  [[nodiscard]] std::optional<std::string> refused() const;

 private:
  std::string raster_;
  std::optional<CPLConfigOptionSetter> no_sidecars_;
  int number_;
};

}  // namespace landfall
