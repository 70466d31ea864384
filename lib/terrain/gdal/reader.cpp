// SPDX-License-Identifier: GPL-3.0-or-later
// GDAL's side of load_dem() (lib/terrain/gdal/gdal_loader.h), and the plugin's table.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "terrain/gdal/geopackage_writer.h"
#include "terrain/gdal/geotiff_writer.h"
#include "terrain/gdal/open_raster.h"
#include "terrain/gdal/plugin.h"
#include "terrain/gdal/raster_files.h"
#include "terrain/gdal/vertical_unit.h"

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kMebi = std::int64_t{1} << 20U;
constexpr std::int64_t kWholeLimit = 64 * kMebi;
constexpr std::int64_t kWindowLimit = 256 * kMebi;
constexpr std::int64_t kStripSamples = 4 * kMebi;

/// A rectangle of a raster's samples.
struct Window {
  std::int64_t row = 0;
  std::int64_t col = 0;
  RasterSize size;
};

/// The whole raster up to the size limit, else the part that the site and its interpolation need.
Window window_to_read(const OpenRaster& raster, const SiteMapping& mapping, const GridSpec& site,
                      const DemBase& dem) {
  const auto [rows, cols] = raster.size;
  if (rows * cols <= kWholeLimit) return {0, 0, raster.size};
  constexpr double kMargin = 3;
  const PixelBox box = pixel_box(mapping, site);
  const auto first = [](double low) { return std::max<std::int64_t>(0, std::llround(low - kMargin)); };
  const auto count = [](double high, std::int64_t begin, std::int64_t limit) {
    return std::min<std::int64_t>(limit, std::llround(high + kMargin) + 1) - begin;
  };
  const std::int64_t row = first(box.low.row);
  const std::int64_t col = first(box.low.col);
  const Window window{row, col, {count(box.high.row, row, rows), count(box.high.col, col, cols)}};
  if (window.size.rows * window.size.cols > kWindowLimit)
    throw FormatError(
        dem.path + ": the site needs " + std::to_string(window.size.cols) + " x " +
        std::to_string(window.size.rows) +
        " pixels, more than 256 Mpx; ask for a smaller half width, or a coarser raster (gdalwarp -tr)");
  return window;
}

/// The raw number that means "no data", in the band's own type.
struct Nodata {
  std::optional<double> value;
  bool single_precision = false;

  [[nodiscard]] bool matches(double raw) const {
    if (!value) return false;
    return single_precision ? static_cast<float>(raw) == static_cast<float>(*value) : raw == *value;
  }
};

/// GDAL before 3.7 has no type for signed bytes: it reads them as unsigned ones and says so.
bool is_signed_byte(GDALRasterBand& band) {
  const char* const type = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  return band.GetRasterDataType() == GDT_Byte && type != nullptr && EQUAL(type, "SIGNEDBYTE");
}

double as_signed_byte(double raw) { return raw > 127 ? raw - 256 : raw; }

Nodata nodata_of(GDALRasterBand& band, bool is_signed_byte) {
  const GDALDataType type = band.GetRasterDataType();
  int given = 0;
  double value = kNan;
  if (type == GDT_Int64)
    value = static_cast<double>(band.GetNoDataValueAsInt64(&given));
  else if (type == GDT_UInt64)
    value = static_cast<double>(band.GetNoDataValueAsUInt64(&given));
  else
    value = band.GetNoDataValue(&given);
  if (is_signed_byte) value = as_signed_byte(value);
  return {given != 0 ? std::optional(value) : std::nullopt, type == GDT_Float32};
}

/// Metres from raw numbers, in the unit that the raster declares: z = scale raw + offset.
struct Scaling {
  double scale = 1;
  double offset = 0;
};

Scaling scaling_of(const OpenRaster& raster, const DemBase& dem) {
  GDALRasterBand& band = *raster.band;
  int given = 0;
  Scaling scaling;
  const double scale = band.GetScale(&given);
  if (given != 0) scaling.scale = scale;
  const double offset = band.GetOffset(&given);
  if (given != 0) scaling.offset = offset;
  if (!std::isfinite(scaling.scale) || !std::isfinite(scaling.offset) || scaling.scale == 0)
    throw FormatError(dem.path + ": band " + std::to_string(dem.band) + " has a scale of 0 or not finite");
  const double unit_m = metres_per_elevation_unit(raster, dem);
  return {scaling.scale * unit_m, scaling.offset * unit_m};
}

/// Reads a window strip by strip to limit the memory that GDAL needs.
class WindowReader {
 public:
  WindowReader(const OpenRaster& raster, const DemBase& dem, GdalErrors& errors)
      : guard_(*raster.guard),
        band_(*raster.band),
        dem_(dem),
        errors_(errors),
        type_(band_.GetRasterDataType()),
        is_signed_byte_(is_signed_byte(band_)),
        nodata_(nodata_of(band_, is_signed_byte_)),
        scaling_(scaling_of(raster, dem)) {
    // The nodata value is compared here, in the band's own type; GDAL evaluates any other mask.
    const int flags = band_.GetMaskFlags();
    if (flags != GMF_ALL_VALID && flags != GMF_NODATA) mask_ = band_.GetMaskBand();
  }

  DemSamples read(const Window& window) {
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

 private:
  void read_strip(const Window& strip, double* out) {
    const auto count = static_cast<std::size_t>(strip.size.rows * strip.size.cols);
    read_numbers(strip, out, count);
    for (std::size_t i = 0; i < count; ++i) {
      const double z = scaling_.scale * out[i] + scaling_.offset;
      out[i] = nodata_.matches(out[i]) || !std::isfinite(z) ? kNan : z;
    }
    if (mask_ == nullptr) return;
    mask_values_.resize(count);
    transfer(*mask_, strip, mask_values_.data(), GDT_Byte);
    for (std::size_t i = 0; i < count; ++i)
      if (mask_values_[i] == 0) out[i] = kNan;
  }

  /// Reads the numbers in the type of the band, to which a VRT rounds resampled values.
  void read_numbers(const Window& strip, double* out, std::size_t count) {
    if (type_ == GDT_Float64) return transfer(band_, strip, out, type_);
    const int bytes = GDALGetDataTypeSizeBytes(type_);
    raw_.resize(count * static_cast<std::size_t>(bytes));
    transfer(band_, strip, raw_.data(), type_);
    GDALCopyWords64(raw_.data(), type_, bytes, out, GDT_Float64, sizeof(double),
                    static_cast<GPtrDiff_t>(count));
    if (is_signed_byte_) std::ranges::transform(std::span(out, count), out, as_signed_byte);
  }

  /// Throws unless all of it was read. Also checks the errors, since some drivers go on after an error.
  void transfer(GDALRasterBand& band, const Window& w, void* out, GDALDataType type) {
    errors_.clear();
    const CPLErr status =
        band.RasterIO(GF_Read, static_cast<int>(w.col), static_cast<int>(w.row),
                      static_cast<int>(w.size.cols), static_cast<int>(w.size.rows), out,
                      static_cast<int>(w.size.cols), static_cast<int>(w.size.rows), type, 0, 0, nullptr);
    if (status == CE_None && !errors_.any()) return;
    refuse_link(guard_, dem_);
    throw FormatError(dem_.path + ": cannot read rows " + std::to_string(w.row) + " .. " +
                      std::to_string(w.row + w.size.rows - 1) +
                      ": the file, or one that it names, is missing, truncated or damaged (" +
                      errors_.reason() + "); get or export it again");
  }

  const FileGuard& guard_;
  GDALRasterBand& band_;
  const DemBase& dem_;
  GdalErrors& errors_;
  GDALDataType type_;
  bool is_signed_byte_;
  Nodata nodata_;
  Scaling scaling_;
  GDALRasterBand* mask_ = nullptr;
  std::vector<unsigned char> raw_;
  std::vector<unsigned char> mask_values_;
};

/// A missing tag would change the position, the scale or the holes of the raster.
void require_no_loss(const DemBase& dem, const GdalErrors& errors) {
  if (!errors.loss().empty())
    throw FormatError(dem.path + ": cannot be read as a whole (" + errors.loss() +
                      "); get or export it again");
}

/// Damage of the file is reported before anything missing: a horizontal scale would not repair it.
SiteFrame frame_of(const OpenRaster& raster, const DemBase& dem, GdalErrors& errors) {
  const Georeference reference = georeference(raster);
  require_no_loss(dem, errors);
  if (reference.crs == nullptr && !dem.horizontal_scale_m)
    (void)WindowReader(raster, dem, errors).read({raster.size.rows / 2, raster.size.cols / 2, {1, 1}});
  return site_frame(reference, dem);
}

DemRaster read_dem(const DemBase& dem, const GridSpec& site, RasterLinks links) {
  GdalErrors errors;
  const OpenRaster raster = open_raster(dem, links, errors);
  SiteFrame frame = frame_of(raster, dem, errors);
  require_site_inside(frame.mapping, raster.size, dem.interpolation, site, dem.path);
  const Window window = window_to_read(raster, frame.mapping, site, dem);
  DemSamples samples = WindowReader(raster, dem, errors).read(window);
  require_no_loss(dem, errors);
  const PixelPosition first{static_cast<double>(window.col), static_cast<double>(window.row)};
  const char* const driver = GDALGetDriverShortName(raster.dataset->GetDriver());
  return {std::move(samples),
          frame.mapping.in_window(first),
          std::move(frame.crs_wkt),
          {dem.path, driver, raster.size, dem.band}};
}

SiteSize fit_dem_site(const DemBase& dem, const SiteRequest& request, RasterLinks links) {
  GdalErrors errors;
  const OpenRaster raster = open_raster(dem, links, errors);
  const SiteFrame frame = frame_of(raster, dem, errors);
  return fit_site({frame.mapping, raster.size, frame.posting_m}, dem.interpolation, request, dem.path);
}

}  // namespace
}  // namespace landfall

extern "C" const landfall::GdalPlugin landfall_gdal_plugin;
const landfall::GdalPlugin landfall_gdal_plugin{LANDFALL_VERSION,
                                                &landfall::read_dem,
                                                &landfall::fit_dem_site,
                                                &landfall::named_files,
                                                &landfall::all_dem_files,
                                                &landfall::write_cloud_optimized_geotiff,
                                                &landfall::write_geopackage_points};
