// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/raster/grid_spec.h"
#include "chain/terrain/relief/site_mapping.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// How to treat files that a raster refers to but that do not belong to it, such as the sources of a VRT.
///
/// The parts of a raster are the file itself and the files in its folder whose names begin with its own up to
/// the last dot: the image of a detached label, headers, world files, masks. For an archive it is the
/// archive, for a folder all files in it.
enum class RasterLinks { refused, followed };

/// The site frame of a terrain without a CRS: metres, x east, y north. WKT2.
inline constexpr const char* kLocalSiteCrsWkt =
    R"wkt(ENGCRS["landfall site frame",EDATUM["landing site"],CS[Cartesian,2],)wkt"
    R"wkt(AXIS["easting (E)",east,ORDER[1],LENGTHUNIT["metre",1]],)wkt"
    R"wkt(AXIS["northing (N)",north,ORDER[2],LENGTHUNIT["metre",1]]])wkt";

struct RasterSize {
  std::int64_t rows = 0;
  std::int64_t cols = 0;
  friend bool operator==(const RasterSize&, const RasterSize&) = default;
};

/// Raster samples, row-major, in the file's order of rows; holes are NaN.
struct DemSamples {
  RasterSize size;
  std::vector<double> values;
  [[nodiscard]] double at(std::int64_t row, std::int64_t col) const {
    return values[static_cast<std::size_t>(row * size.cols + col)];
  }
};

/// The source of a DEM, for provenance.
struct DemSource {
  std::string path;
  std::string driver;  ///< GDAL's short name
  RasterSize size;     ///< of the whole raster, not of the window that was read
  int band = 1;
  /// The statements that the raster lacked or contradicted, and the assumptions instead; sentences
  /// without its name.
  std::vector<std::string> assumed = {};
  friend bool operator==(const DemSource&, const DemSource&) = default;
};

/// An imported raster: elevations in metres (in the raster's own unit if vertical_scale is set), before
/// datum, and the site's position in it.
struct DemRaster {
  DemSamples samples;   ///< the raster, or a window of it that holds the site
  SiteMapping mapping;  ///< to pixels of `samples`
  std::string crs_wkt;  ///< of the site frame
  DemSource source;
};

/// Reads the raster of a DemBase for a site; lib/formats/gdal/gdal_loader.h has the loader for files.
using DemLoader = std::function<DemRaster(const DemBase& dem, const GridSpec& site)>;

/// The elevation at `pixel`; NaN in holes and outside the samples. Inside means within the hull of the pixel
/// centres or, for `nearest`, of the pixels' outer edges; 1e-6 pixel beyond counts as on the border. Within
/// 1e-6 pixel of a pixel's centre the result is that sample alone, so that a hole next to it does not matter.
///
/// - nearest: the pixel that holds the point, the greater one on an edge.
/// - bilinear: reproduces a + b x + c y + d x y. NaN where a sample of non-zero weight is NaN.
/// - bicubic: Keys (1981), a = -1/2, on 4 x 4 samples: reproduces products of quadratics in x and in y, but
///   within one pixel of the border, where the missing ring repeats the border. Where a sample of non-zero
///   weight is NaN it is bilinear, so that holes do not grow.
[[nodiscard]] double interpolate(const DemSamples& samples, Interpolation method, const PixelPosition& pixel);

/// True where interpolate() has samples to interpolate.
[[nodiscard]] bool inside(const RasterSize& size, Interpolation method, const PixelPosition& pixel);

/// A box of continuous pixel coordinates, inclusive.
struct PixelBox {
  PixelPosition low;
  PixelPosition high;
};

/// True where all of the box is inside().
[[nodiscard]] bool box_inside(const RasterSize& size, Interpolation method, const PixelBox& box);

/// The pixels under the nodes of a site, computed from the nodes of its border; NaN if one of them has no
/// position in the raster's coordinates.
[[nodiscard]] PixelBox pixel_box(const SiteMapping& mapping, const GridSpec& site);

/// The largest half width around the site's centre, in nodes of `resolution_m` and up to `limit`, whose
/// square lies inside a raster of this size; -1 if the centre lies outside.
[[nodiscard]] std::int64_t largest_half(const SiteMapping& mapping, const RasterSize& size,
                                        Interpolation method, double resolution_m, std::int64_t limit);

/// Throws FormatError unless all of the site lies inside a raster of this size; the message begins with
/// `what` and names the size and the largest half width (a multiple of the resolution) that fits around the
/// same centre.
void require_site_inside(const SiteMapping& mapping, const RasterSize& size, Interpolation method,
                         const GridSpec& site, const std::string& what);

}  // namespace landfall
