// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/gdal/window_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "base/core/error.h"
#include "base/numerics/non_finite.h"

namespace landfall {
namespace {

constexpr std::int64_t kStripSamples = std::int64_t{4} << 20U;

}  // namespace

WindowReader::WindowReader(const OpenRaster& raster, const RasterStatement& statement, const DemBase& dem,
                           GdalErrors& errors)
    : guard_(*raster.guard),
      band_(*raster.band),
      statement_(statement),
      dem_(dem),
      errors_(errors),
      type_(band_.GetRasterDataType()),
      is_signed_byte_(is_signed_byte(band_)) {
  for (const double value : statement.nodata)
    nodata_.push_back(type_ == GDT_Float32 ? static_cast<double>(static_cast<float>(value)) : value);
  // The nodata values are compared here, in the band's own type; GDAL evaluates any other mask.
  const int flags = band_.GetMaskFlags();
  if (flags != GMF_ALL_VALID && flags != GMF_NODATA) mask_ = band_.GetMaskBand();
}

DemSamples WindowReader::read(const Window& window) {
  // Grown strip by strip, so that a file costs no more memory than it has data.
  DemSamples samples{window.size, {}};
  samples.values.reserve(static_cast<std::size_t>(window.size.rows * window.size.cols));
  const std::int64_t step = std::max<std::int64_t>(1, kStripSamples / window.size.cols);
  for (std::int64_t row = 0; row < window.size.rows; row += step) {
    const std::int64_t rows = std::min(step, window.size.rows - row);
    samples.values.resize(static_cast<std::size_t>((row + rows) * window.size.cols));
    double* out = samples.values.data() + row * window.size.cols;
    read_strip({window.row + row, window.col, {rows, window.size.cols}}, out);
  }
  return samples;
}

double WindowReader::elevation_of(double raw) const {
  if (std::ranges::find(nodata_, raw) != nodata_.end()) return kNan;
  const double z = statement_.elevation.scale * raw + statement_.elevation.offset;
  if (!std::isfinite(z)) return kNan;
  if (!statement_.valid) return z;
  const auto [low, high, unpacked] = *statement_.valid;
  const double value = unpacked ? statement_.packing.scale * raw + statement_.packing.offset : raw;
  return value >= low && value <= high ? z : kNan;
}

void WindowReader::read_strip(const Window& strip, double* out) {
  const auto count = static_cast<std::size_t>(strip.size.rows * strip.size.cols);
  read_numbers(strip, out, count);
  std::transform(out, out + count, out, [this](double raw) { return elevation_of(raw); });
  if (mask_ == nullptr) return;
  mask_values_.resize(count);
  transfer(*mask_, strip, mask_values_.data(), GDT_Byte);
  for (std::size_t i = 0; i < count; ++i)
    if (mask_values_[i] == 0) out[i] = std::numeric_limits<double>::quiet_NaN();
}

/// Reads the numbers in the type of the band, to which a VRT rounds resampled values.
void WindowReader::read_numbers(const Window& strip, double* out, std::size_t count) {
  if (type_ == GDT_Float64) return transfer(band_, strip, out, type_);
  const int bytes = GDALGetDataTypeSizeBytes(type_);
  raw_.resize(count * static_cast<std::size_t>(bytes));
  transfer(band_, strip, raw_.data(), type_);
  GDALCopyWords64(raw_.data(), type_, bytes, out, GDT_Float64, sizeof(double),
                  static_cast<GPtrDiff_t>(count));
  if (is_signed_byte_) std::ranges::transform(std::span(out, count), out, as_signed_byte);
}

/// Also checks the errors, since some drivers continue after an error.
void WindowReader::transfer(GDALRasterBand& band, const Window& w, void* out, GDALDataType type) {
  errors_.clear();
  const CPLErr status =
      band.RasterIO(GF_Read, static_cast<int>(w.col), static_cast<int>(w.row), static_cast<int>(w.size.cols),
                    static_cast<int>(w.size.rows), out, static_cast<int>(w.size.cols),
                    static_cast<int>(w.size.rows), type, 0, 0, nullptr);
  if (status == CE_None && !errors_.any()) return;
  refuse_link(guard_, dem_);
  throw FormatError(dem_.path + ": cannot read rows " + std::to_string(w.row) + " .. " +
                    std::to_string(w.row + w.size.rows - 1) +
                    ": the file, or one that it names, is missing, truncated or damaged (" +
                    errors_.reason() + "); get or export it again");
}

}  // namespace landfall
