// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "formats/gdal/raster_statement.h"

namespace landfall {

/// A rectangle of a raster's samples.
struct Window {
  std::int64_t row = 0;
  std::int64_t col = 0;
  RasterSize size;
};

/// Reads windows strip by strip to limit the memory that GDAL needs. Values are scaled; holes are NaN:
/// nodata, outside the valid range, masked, not finite.
class WindowReader {
 public:
  WindowReader(const OpenRaster& raster, const RasterStatement& statement, const DemBase& dem,
               GdalErrors& errors);

  /// Throws FormatError unless all of it was read.
  [[nodiscard]] DemSamples read(const Window& window);

 private:
  void read_strip(const Window& strip, double* out);
  void read_numbers(const Window& strip, double* out, std::size_t count);
  void transfer(GDALRasterBand& band, const Window& window, void* out, GDALDataType type);
  [[nodiscard]] double elevation_of(double raw) const;

  const FileGuard& guard_;
  GDALRasterBand& band_;
  const RasterStatement& statement_;
  const DemBase& dem_;
  GdalErrors& errors_;
  GDALDataType type_;
  bool is_signed_byte_;
  std::vector<double> nodata_;  ///< as the type of the band rounds them
  GDALRasterBand* mask_ = nullptr;
  std::vector<unsigned char> raw_;
  std::vector<unsigned char> mask_values_;
};

}  // namespace landfall
