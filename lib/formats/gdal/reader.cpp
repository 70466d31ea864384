// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D18
// GDAL's side of load_dem() (lib/formats/gdal/gdal_loader.h), and the plugin's table.
//
// Damaged rasters are recognised by their data, not by what their headers declare: samples are stored as
// they are read, strip by strip, so that a header that declares 10^14 pixels takes no memory; GDAL's block
// cache is 64 MiB, and blocks above 256 MiB are refused. A DTED cell that claims to be complete must have
// all its columns, which GDAL would otherwise treat as holes. A classic netCDF file must be as long as its
// header says, because its library reads missing values as zeros. Damage is reported before a missing
// scale.
//
// A raster never leads to another machine. Unless the configured path itself contains `/vsi` or `://`,
// GDAL's web drivers are disabled, and `/vsicurl/` and related file systems open nothing.
// lib/formats/gdal/file_guard.cpp says which local files it may lead to.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "formats/gdal/fill_values.h"
#include "formats/gdal/map_frame.h"
#include "formats/gdal/map_position.h"
#include "formats/gdal/open_raster.h"
#include "formats/gdal/plugin.h"
#include "formats/gdal/raster_files.h"
#include "formats/gdal/raster_statement.h"
#include "formats/gdal/registry.h"
#include "formats/gdal/window_reader.h"

namespace landfall {
namespace {

constexpr std::int64_t kMebi = std::int64_t{1} << 20U;
constexpr std::int64_t kWholeLimit = 64 * kMebi;
constexpr std::int64_t kWindowLimit = 256 * kMebi;

/// The part of a raster that a site and its interpolation need.
Window needed_window(const RasterSize& size, const SiteMapping& mapping, const GridSpec& site,
                     const DemBase& dem) {
  constexpr double kMargin = 3;
  const PixelBox box = pixel_box(mapping, site);
  const auto first = [](double low) { return std::max<std::int64_t>(0, std::llround(low - kMargin)); };
  const auto count = [](double high, std::int64_t begin, std::int64_t limit) {
    return std::min<std::int64_t>(limit, std::llround(high + kMargin) + 1) - begin;
  };
  const std::int64_t row = first(box.low.row);
  const std::int64_t col = first(box.low.col);
  const Window window{row, col, {count(box.high.row, row, size.rows), count(box.high.col, col, size.cols)}};
  if (window.size.rows * window.size.cols > kWindowLimit)
    throw FormatError(
        dem.path + ": the site needs " + std::to_string(window.size.cols) + " x " +
        std::to_string(window.size.rows) +
        " pixels, more than 256 Mpx; ask for a smaller half width, or a coarser raster (gdalwarp -tr)");
  return window;
}

/// The whole raster up to the size limit, else the part that the site needs.
Window window_to_read(const OpenRaster& raster, const SiteMapping& mapping, const GridSpec& site,
                      const DemBase& dem) {
  if (raster.size.rows * raster.size.cols <= kWholeLimit) return {0, 0, raster.size};
  return needed_window(raster.size, mapping, site, dem);
}

/// A raster of longitudes and latitudes continued beyond its seam and its poles (RasterCover): its columns
/// once more on both sides, and a few rows of the other side of the body.
class ContinuedRaster {
 public:
  ContinuedRaster(const RasterSize& size, const RasterCover& cover) : size_(size), cover_(cover) {}

  [[nodiscard]] RasterSize size() const {
    return {top() + size_.rows + (cover_.last_pole ? kBeyondPole : 0), size_.cols + 2 * cover_.period};
  }
  /// A mapping to the raster as one to the continued raster.
  [[nodiscard]] SiteMapping mapping(const SiteMapping& own) const {
    return own.in_window({-static_cast<double>(cover_.period), -static_cast<double>(top())});
  }

  /// A window of the continued raster.
  [[nodiscard]] DemSamples read(WindowReader& reader, const Window& window) const {
    std::int64_t first = size_.rows;
    std::int64_t last = -1;
    for (std::int64_t row = 0; row < window.size.rows; ++row) {
      const std::int64_t own = own_row(window.row + row).row;
      first = std::min(first, own);
      last = std::max(last, own);
    }
    const DemSamples rows = reader.read({first, 0, {last + 1 - first, size_.cols}});
    DemSamples samples{window.size, {}};
    samples.values.reserve(static_cast<std::size_t>(window.size.rows * window.size.cols));
    for (std::int64_t row = 0; row < window.size.rows; ++row) {
      const Place place = own_row(window.row + row);
      for (std::int64_t col = 0; col < window.size.cols; ++col)
        samples.values.push_back(rows.at(place.row - first, own_col(window.col + col + place.turned)));
    }
    return samples;
  }

 private:
  static constexpr std::int64_t kBeyondPole = 8;

  struct Place {
    std::int64_t row;
    std::int64_t turned;  ///< columns by which the other side of a pole is turned
  };

  [[nodiscard]] std::int64_t top() const { return cover_.first_pole ? kBeyondPole : 0; }
  [[nodiscard]] Place own_row(std::int64_t continued) const {
    const std::int64_t row = continued - top();
    const auto mirrored = [&](double pole) { return Place{std::llround(2 * pole) - row, cover_.period / 2}; };
    if (row < 0) return mirrored(*cover_.first_pole);
    if (row >= size_.rows) return mirrored(*cover_.last_pole);
    return {row, 0};
  }
  [[nodiscard]] std::int64_t own_col(std::int64_t continued) const {
    const std::int64_t col = (continued - cover_.period) % cover_.period;
    return col < 0 ? col + cover_.period : col;
  }

  RasterSize size_;
  RasterCover cover_;
};

/// A missing tag would change the position, the scale or the holes of the raster.
void require_no_loss(const DemBase& dem, const GdalErrors& errors) {
  if (!errors.loss().empty())
    throw FormatError(dem.path + ": cannot be read as a whole (" + errors.loss() +
                      "); get or export it again");
}

/// Damage of the file is reported before anything missing: a horizontal scale would not repair it.
SiteFrame frame_of(const OpenRaster& raster, const RasterStatement& statement, const DemBase& dem,
                   GdalErrors& errors) {
  require_no_loss(dem, errors);
  if (statement.georeference.crs == nullptr && !dem.horizontal_scale_m)
    (void)WindowReader(raster, statement, dem, errors)
        .read({raster.size.rows / 2, raster.size.cols / 2, {1, 1}});
  return site_frame(statement.georeference, dem);
}

/// The mapping in a form that is fast and safe for many points of the site.
SiteMapping smoothed(const SiteMapping& mapping, const GridSpec& site, const DemBase& dem) {
  const double half_width_m =
      std::max({-site.x(0), site.x(site.cols - 1), -site.y(0), site.y(site.rows - 1), site.resolution_m});
  if (auto smooth = mapping.smoothed(half_width_m)) return std::move(*smooth);
  throw FormatError(
      dem.path +
      ": its map projection has a seam or an edge within the site; give another center or a smaller "
      "half width, or reproject it around the site (gdalwarp -t_srs +proj=ortho)");
}

struct SiteSamples {
  DemSamples samples;
  SiteMapping mapping;  ///< to pixels of `samples`
};

/// True where interpolation needs no sample beyond the raster.
bool reaches_no_edge(const RasterSize& size, const PixelBox& box) {
  constexpr double kReach = 2;  // of bicubic interpolation
  return box.low.col >= kReach && box.high.col <= static_cast<double>(size.cols - 1) - kReach &&
         box.low.row >= kReach && box.high.row <= static_cast<double>(size.rows - 1) - kReach;
}

SiteSamples read_site(const OpenRaster& raster, const SiteFrame& frame, const GridSpec& site,
                      const DemBase& dem, WindowReader& reader) {
  SiteMapping mapping = smoothed(frame.mapping, site, dem);
  const ContinuedRaster continued(raster.size, frame.cover);
  const auto at = [](const Window& window) {
    return PixelPosition{static_cast<double>(window.col), static_cast<double>(window.row)};
  };
  if (frame.cover.period > 0 && !reaches_no_edge(raster.size, pixel_box(mapping, site))) {
    mapping = continued.mapping(mapping);
    require_site_inside(mapping, continued.size(), dem.interpolation, site, dem.path);
    const Window window = needed_window(continued.size(), mapping, site, dem);
    return {continued.read(reader, window), mapping.in_window(at(window))};
  }
  require_site_inside(mapping, raster.size, dem.interpolation, site, dem.path);
  const Window window = window_to_read(raster, mapping, site, dem);
  return {reader.read(window), mapping.in_window(at(window))};
}

DemRaster read_dem(const DemBase& dem, const GridSpec& site, RasterLinks links) {
  GdalErrors errors;
  const OpenRaster raster = open_raster(dem, links, errors);
  const RasterStatement statement = raster_statement(raster, dem);
  SiteFrame frame = frame_of(raster, statement, dem, errors);
  WindowReader reader(raster, statement, dem, errors);
  SiteSamples read = read_site(raster, frame, site, dem, reader);
  require_no_loss(dem, errors);
  std::vector<std::string> assumed = statement.assumed;
  assumed.insert(assumed.end(), frame.assumed.begin(), frame.assumed.end());
  const bool is_integer = GDALDataTypeIsInteger(raster.band->GetRasterDataType()) != 0;
  if (auto zeros = check_fill_values(read.samples, pixel_box(read.mapping, site), statement.elevation,
                                     is_integer, dem))
    assumed.push_back(std::move(*zeros));
  const char* const driver = GDALGetDriverShortName(raster.dataset->GetDriver());
  return {std::move(read.samples),
          read.mapping,
          std::move(frame.crs_wkt),
          {dem.path, driver, raster.size, dem.band, std::move(assumed)}};
}

SiteSize fit_dem_site(const DemBase& dem, const SiteRequest& request, RasterLinks links) {
  GdalErrors errors;
  const OpenRaster raster = open_raster(dem, links, errors);
  const SiteFrame frame = frame_of(raster, raster_statement(raster, dem), dem, errors);
  const ContinuedRaster continued(raster.size, frame.cover);
  const bool closes = frame.cover.period > 0;
  return fit_site({closes ? continued.mapping(frame.mapping) : frame.mapping,
                   closes ? continued.size() : raster.size, frame.posting_m},
                  dem.interpolation, request, dem.path);
}

std::string site_of_raster(const DemBase& dem, RasterLinks links) {
  GdalErrors errors;
  const OpenRaster raster = open_raster(dem, links, errors);
  return frame_of(raster, raster_statement(raster, dem), dem, errors).crs_wkt;
}

}  // namespace
}  // namespace landfall

extern "C" const landfall::GdalPlugin landfall_gdal_plugin;
const landfall::GdalPlugin landfall_gdal_plugin{LANDFALL_VERSION,
                                                &landfall::ignore_gdal_options,
                                                &landfall::read_dem,
                                                &landfall::fit_dem_site,
                                                &landfall::named_files,
                                                &landfall::all_dem_files,
                                                &landfall::point_frame_in_map,
                                                &landfall::grid_of_raster,
                                                &landfall::sample_at_bins,
                                                &landfall::write_cloud_optimized_geotiff,
                                                &landfall::write_geopackage_points,
                                                &landfall::map_positions_of,
                                                &landfall::map_frame_of,
                                                &landfall::read_polygons,
                                                &landfall::site_of_raster,
                                                &landfall::is_one_map,
                                                &landfall::transform_between,
                                                &landfall::proj_text_of};
