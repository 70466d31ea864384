// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <memory>

#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/terrain_model.h"
#include "formats/gdal/file_guard.h"
#include "formats/gdal/gdal_errors.h"

namespace landfall {

/// While one lives, GDAL's drivers report on this thread what they skip by default: wrong checksums of DTED,
/// damaged or truncated JPEG data, and the vertical CRS of GeoTIFF 1.0. A value that the user has set
/// (environment) stays.
class StrictReading {
 public:
  StrictReading() {
    for (std::size_t i = 0; i < kOptions.size(); ++i) {
      is_set_[i] = CPLGetConfigOption(kOptions[i], nullptr) == nullptr;
      if (is_set_[i]) CPLSetThreadLocalConfigOption(kOptions[i], "YES");
    }
  }
  ~StrictReading() {
    for (std::size_t i = 0; i < kOptions.size(); ++i)
      if (is_set_[i]) CPLSetThreadLocalConfigOption(kOptions[i], nullptr);
  }
  StrictReading(const StrictReading&) = delete;
  StrictReading& operator=(const StrictReading&) = delete;

 private:
  static constexpr std::array<const char*, 3> kOptions = {
      "DTED_VERIFY_CHECKSUM", "GDAL_ERROR_ON_LIBJPEG_WARNING", "GTIFF_REPORT_COMPD_CS"};
  std::array<bool, kOptions.size()> is_set_{};
};

struct OpenRaster {
  std::unique_ptr<StrictReading> checks;  ///< outlives the dataset, as the guard does
  std::unique_ptr<FileGuard> guard;       ///< outlives the dataset
  GDALDatasetUniquePtr dataset;
  GDALRasterBand* band;
  RasterSize size;
  std::unique_ptr<OGRSpatialReference> given_crs = nullptr;  ///< in place of its own (DemBase::crs)
};

/// Opens the band of a DemBase and checks it by its header, before a sample is read. Throws UsageError for
/// a band that does not exist and for a DemBase::crs that is none; FormatError where the raster or a file
/// that it names is a pipe or device, where it cannot be opened, needs a file that may not be followed, is
/// smaller than 2 x 2, is complex-valued, has blocks of more than 256 MiB or is shorter than its header
/// implies. Messages suggest a remedy.
[[nodiscard]] OpenRaster open_raster(const DemBase& dem, RasterLinks links, const GdalErrors& errors);

/// GDAL before 3.7 has no type for signed bytes: it reads them as unsigned ones and says so.
[[nodiscard]] bool is_signed_byte(GDALRasterBand& band);
[[nodiscard]] inline double as_signed_byte(double raw) { return raw > 127 ? raw - 256 : raw; }

/// Throws FormatError if the raster's guard refused a file, which then explains a failure.
void refuse_link(const FileGuard& guard, const DemBase& dem);

}  // namespace landfall
