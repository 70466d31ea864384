// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/gdal/gdal_loader.h"

#include <string>
#include <vector>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/core/plugin_file.h"
#include "chain/terrain/site_wkt.h"
#include "formats/gdal/map_frame.h"
#include "formats/gdal/plugin.h"

namespace landfall {
namespace {

/// GDAL, its hundred libraries and their initialisation; some of them crash with less memory.
constexpr std::size_t kHeadroomOfGdal = std::size_t{192} << 20U;

const GdalPlugin& find_plugin() {
  const auto& found = *static_cast<const GdalPlugin*>(load_plugin({.file = "landfall-gdal.so",
                                                                   .name = "GDAL",
                                                                   .needed_by = "rasters need",
                                                                   .symbol = kGdalPluginSymbol,
                                                                   .headroom = kHeadroomOfGdal}));
  found.ignore_options();
  return found;
}

/// Never unloaded because GDAL keeps pointers into it. The next call repeats a search that failed.
const GdalPlugin& plugin() {
  static const GdalPlugin& found = find_plugin();
  return found;
}

/// Without the plugin the raster cannot be read; the message must not blame the output of the run.
const GdalPlugin& plugin_for(const DemBase& dem) {
  try {
    return plugin();
  } catch (const IoError& error) {
    throw FormatError(dem.path + ": " + error.what());
  }
}

/// A map projection, in WKT2 or WKT1.
bool is_tied_to_body(const std::string& site_wkt) { return site_wkt.starts_with("PROJC"); }

}  // namespace

DemRaster load_dem(const DemBase& dem, const GridSpec& site) {
  return plugin_for(dem).read_dem(dem, site, RasterLinks::refused);
}

DemLoader dem_loader(RasterLinks links) {
  return [links](const DemBase& dem, const GridSpec& site) {
    return plugin_for(dem).read_dem(dem, site, links);
  };
}

SiteSize fit_dem_site(const DemBase& dem, const SiteRequest& request, RasterLinks links) {
  return plugin_for(dem).fit_dem_site(dem, request, links);
}

std::vector<std::string> named_dem_files(const DemBase& dem, RasterLinks links) {
  return plugin_for(dem).named_files(dem.path, links);
}

std::vector<std::string> dem_files(const DemBase& dem, RasterLinks links) {
  return plugin_for(dem).dem_files(dem, links);
}

PointFrame point_frame(const PointFrameRequest& request) {
  if (!request.crs.is_given()) return local_point_frame(request);
  try {
    return plugin().point_frame(request);
  } catch (const IoError& error) {
    throw FormatError(request.name + ": " + error.what());
  }
}

RasterGrid raster_grid(const DemBase& dem, RasterLinks links) {
  return plugin_for(dem).raster_grid(dem, links);
}

SampledRaster sample_raster(const DemBase& raster, const RasterGrid& grid, RasterLinks links) {
  return plugin_for(raster).sample_raster(raster, grid, links);
}

void write_geotiff(const OutputOptions& options, const GeotiffContent& content,
                   const ProgressCallback& progress) {
  OutputPath output(options.path, options.overwrite);
  plugin().write_geotiff(output.temporary().string(), content,
                         {options.compression, thread_supply(thread_count())}, progress);
  output.commit();
}

void write_geopackage(const OutputOptions& options, const PointLayer& layer) {
  OutputPath output(options.path, options.overwrite);
  plugin().write_geopackage_points(output.temporary().string(), layer);
  output.commit();
}

std::vector<MapPosition> map_positions(const std::string& site_wkt, const std::vector<SitePoint>& points) {
  if (!is_tied_to_body(site_wkt) || no_map_positions(site_wkt))
    return std::vector<MapPosition>(points.size());
  return plugin().map_positions(site_wkt, points);
}

std::string raster_site(const DemBase& dem, RasterLinks links) {
  return plugin_for(dem).raster_site(dem, links);
}

bool one_map(const std::string& a_wkt, const std::string& b_wkt) { return plugin().one_map(a_wkt, b_wkt); }

SiteTransform site_transform(const std::string& from_wkt, const std::string& to_wkt) {
  return plugin().site_transform(from_wkt, to_wkt);
}

std::string proj_text(const std::string& wkt) { return plugin().proj_text(wkt); }

std::optional<MapFrame> map_frame(const std::string& site_wkt) {
  if (!is_tied_to_body(site_wkt) && map_wkt_of(site_wkt).empty()) return std::nullopt;
  return plugin().map_frame(site_wkt);
}

PolygonFile polygon_file(const PolygonFileRequest& request) {
  try {
    return plugin().polygons(request);
  } catch (const IoError& error) {
    throw FormatError(request.path + ": " + error.what());
  }
}

std::optional<std::string> no_map_positions(const std::string& site_wkt) {
  if (!is_tied_to_body(site_wkt)) return std::nullopt;
  try {
    static_cast<void>(plugin());
  } catch (const IoError& error) {
    return error.what();
  }
  return std::nullopt;
}

}  // namespace landfall
