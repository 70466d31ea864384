// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "base/geometry/map_position.h"
#include "base/raster/grid_spec.h"
#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/relief/site_fit.h"
#include "chain/terrain/site_point.h"
#include "chain/terrain/terrain_model.h"
#include "formats/gdal/exported_layers.h"
#include "formats/gdal/point_frame.h"
#include "formats/gdal/polygon_file.h"
#include "formats/gdal/raster_grid.h"
#include "formats/gdal/site_relation.h"

namespace landfall {

struct MapFrame;

/// The functions of the plugin. Loader and plugin must be of one build: `version` detects a stale file.
struct GdalPlugin {
  const char* version;
  void (*ignore_options)();  ///< to be called first
  DemRaster (*read_dem)(const DemBase& dem, const GridSpec& site, RasterLinks links);
  SiteSize (*fit_dem_site)(const DemBase& dem, const SiteRequest& request, RasterLinks links);
  std::vector<std::string> (*named_files)(const std::string& path, RasterLinks links);
  std::vector<std::string> (*dem_files)(const DemBase& dem, RasterLinks links);
  PointFrame (*point_frame)(const PointFrameRequest& request);
  RasterGrid (*raster_grid)(const DemBase& dem, RasterLinks links);
  SampledRaster (*sample_raster)(const DemBase& raster, const RasterGrid& grid, RasterLinks links);
  void (*write_geotiff)(const std::string& path, const GeotiffContent& content, const GeotiffOptions& options,
                        const ProgressCallback& progress);
  void (*write_geopackage_points)(const std::string& path, const PointLayer& layer);
  std::vector<MapPosition> (*map_positions)(const std::string& site_wkt,
                                            const std::vector<SitePoint>& points);
  std::optional<MapFrame> (*map_frame)(const std::string& site_wkt);
  PolygonFile (*polygons)(const PolygonFileRequest& request);
  std::string (*raster_site)(const DemBase& dem, RasterLinks links);
  bool (*one_map)(const std::string& a_wkt, const std::string& b_wkt);
  SiteTransform (*site_transform)(const std::string& from_wkt, const std::string& to_wkt);
  std::string (*proj_text)(const std::string& wkt);
};

/// point_frame() of gdal_loader.h for points with a CRS.
[[nodiscard]] PointFrame point_frame_in_map(const PointFrameRequest& request);

/// raster_grid() and sample_raster() of gdal_loader.h.
[[nodiscard]] RasterGrid grid_of_raster(const DemBase& asked, RasterLinks links);
[[nodiscard]] SampledRaster sample_at_bins(const DemBase& truth, const RasterGrid& grid, RasterLinks links);

/// write_geotiff() and write_geopackage() of gdal_loader.h.
void write_cloud_optimized_geotiff(const std::string& path, const GeotiffContent& content,
                                   const GeotiffOptions& options, const ProgressCallback& progress);
void write_geopackage_points(const std::string& path, const PointLayer& layer);

/// The name of the plugin's one object, of type GdalPlugin.
inline constexpr const char* kGdalPluginSymbol = "landfall_gdal_plugin";

}  // namespace landfall
