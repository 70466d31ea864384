// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "base/geometry/map_position.h"
#include "base/output/output_path.h"
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

/// The DemLoader for files: any raster of the formats that docs/user/terrain-gen.md lists, read by GDAL. GDAL
/// depends on about a hundred shared libraries, so it is in a plugin, landfall-gdal.so, which the first call
/// loads. The plugin is searched for in $LANDFALL_PLUGIN_DIR, then next to the running program
/// (../lib/landfall and ../<libdir>/landfall), then in the installation folder.
///
/// Holes are NaN: pixels marked by the band's nodata value, by its mask or alpha band, or as NaN. Scale and
/// offset are applied. Rasters up to 64 Mpx (2^26) are read whole; of larger ones only the window that the
/// site needs, at most 256 Mpx. The site's frame is
/// - for a projected or local CRS: its own axes, shifted to the centre, in metres;
/// - for a geographic CRS: the orthographic frame of its body around the centre;
/// - without a CRS: the raster's axes times horizontal_scale_m; a raster without georeference counts columns
///   from its left and rows from its bottom edge.
///
/// Opens no file that is not part of the raster (dem_raster.h), connects to no other machine, and runs no
/// code that a file contains.
///
/// Throws UsageError for a horizontal_scale_m that is missing or not allowed, a band that does not exist, and
/// both kinds of centre at once; FormatError where the raster cannot be opened or read, needs a file that is
/// not part of it, is complex-valued, is smaller than 2 x 2, has no usable georeference, or does not hold all
/// of the site, and without the plugin, naming the raster and the paths tried. From any thread, one call at
/// a time: GDAL has one list of drivers, and reading a raster changes it.
[[nodiscard]] DemRaster load_dem(const DemBase& dem, const GridSpec& site);

/// Returns load_dem(), or a loader that opens all local files that a raster refers to.
[[nodiscard]] DemLoader dem_loader(RasterLinks links);

/// The size of a site whose half width or resolution is derived from the raster (site_fit.h). Reads the
/// header; throws as load_dem() and fit_site() do.
[[nodiscard]] SiteSize fit_dem_site(const DemBase& dem, const SiteRequest& request,
                                    RasterLinks links = RasterLinks::refused);

/// The files that a raster's name refers to before GDAL opens any: the file itself, those inside a name such
/// as NETCDF:"f.h5":z, and with RasterLinks::followed those that VRTs among them name. Throws FormatError
/// without the plugin.
[[nodiscard]] std::vector<std::string> named_dem_files(const DemBase& dem, RasterLinks links);

/// The files that load_dem() may read, including files next to a raster that belong to it. Opens the raster,
/// but does not throw if that fails; throws FormatError without the plugin.
[[nodiscard]] std::vector<std::string> dem_files(const DemBase& dem,
                                                 RasterLinks links = RasterLinks::refused);

/// The site frame of points, as load_dem() makes it of a raster: the map's own axes shifted to the centre in
/// metres, or, of longitudes and latitudes and of a map whose scale at the site is not that of the ground,
/// the orthographic frame of the body around the centre. Without a CRS metres are assumed, with a sentence in
/// `assumed`; only with one is the plugin needed.
///
/// Throws UsageError for a CRS option that is not known, FormatError for a CRS of the file that cannot be
/// read, one that is no map, and coordinates that it cannot have.
[[nodiscard]] PointFrame point_frame(const PointFrameRequest& request);

/// The grid whose bins are the pixels of a raster; the pixel nearest to `dem.center`, by default the middle,
/// is its origin. Without a CRS metres are assumed, with a sentence in `assumed`.
///
/// Throws UsageError, with the gdalwarp command that makes such a raster, for pixels that are not square and
/// north up within 1e-6, for longitudes and latitudes, and for a map whose scale at the middle is not 1
/// within 1e-3; for a centre outside the raster; FormatError as load_dem() does.
[[nodiscard]] RasterGrid raster_grid(const DemBase& dem, RasterLinks links = RasterLinks::refused);

/// Another raster at the centres of the bins, bilinear, reprojected by GDAL where its CRS is another one.
/// Throws FormatError if only one of the two has a CRS, if there is no transformation, for more than 2^28
/// pixels, and as load_dem() does.
[[nodiscard]] SampledRaster sample_raster(const DemBase& raster, const RasterGrid& grid,
                                          RasterLinks links = RasterLinks::refused);

/// Writes grids as the bands of a cloud-optimized GeoTIFF: deflate with a predictor, tiles of 512 x 512, each
/// node at the centre of its pixel, row 0 northernmost. All bands have one type: float64 if a band is float64
/// or if there are both float32 and int32, else float32, int32, or int16 for int8. Floating-point files have
/// nodata NaN, integer files no nodata. Overviews hold the mean of the nodes that are not holes; those of
/// integers, which may be flags, hold the middle node. The grids are not copied: memory is needed only for
/// tiles and GDAL's block cache (64 MiB). The file appears complete or not at all (output_path.h).
///
/// Throws UsageError if the output exists, IoError with GDAL's reason, or if the plugin is missing.
void write_geotiff(const OutputOptions& options, const GeotiffContent& content,
                   const ProgressCallback& progress = {});

/// Writes points with z and their attributes as one layer of a GeoPackage in the site's frame, a local one
/// included. Its time of change is 1970, so that equal points give equal bytes. Otherwise as write_geotiff().
void write_geopackage(const OutputOptions& options, const PointLayer& layer);

/// Points of a site on the map that the site was taken from, in their order; empty positions for a frame that
/// is not tied to a body, without loading the plugin, and if the plugin is missing: no_map_positions() then
/// says why.
[[nodiscard]] std::vector<MapPosition> map_positions(const std::string& site_wkt,
                                                     const std::vector<SitePoint>& points);
[[nodiscard]] std::optional<std::string> no_map_positions(const std::string& site_wkt);

/// The frame of the site that load_dem() would give, from the header alone. Throws as load_dem() does.
[[nodiscard]] std::string raster_site(const DemBase& dem, RasterLinks links = RasterLinks::refused);

/// Whether two CRSs are one horizontal CRS, whatever their names and texts.
[[nodiscard]] bool one_map(const std::string& a_wkt, const std::string& b_wkt);

/// The transformation from one site frame to another; without `move` where a frame is not tied to a body,
/// between two bodies, and between datums of different ellipsoids whose shift is not known.
[[nodiscard]] SiteTransform site_transform(const std::string& from_wkt, const std::string& to_wkt);

/// A CRS as a PROJ text, for a command that a user can type; empty where it has none.
[[nodiscard]] std::string proj_text(const std::string& wkt);

/// The polygons of a vector file of the formats that docs/user/dem-eval.md lists, reprojected vertex by
/// vertex to the DEM's frame if the file has a CRS; without one, or with a local one, their coordinates are x
/// and y of that frame.
///
/// Throws UsageError as require_simple() does; FormatError without the plugin, for a file that cannot be
/// read, that holds no polygon or another geometry, that has several layers of which none is chosen, and
/// whose CRS cannot be converted to that of the DEM.
[[nodiscard]] PolygonFile polygon_file(const PolygonFileRequest& request);

}  // namespace landfall
