// SPDX-License-Identifier: GPL-3.0-or-later
#include "gdal_rasters.h"

#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <memory>
#include <stdexcept>
#include <vector>

namespace landfall {
namespace {

void require(bool done) {
  if (!done) throw std::runtime_error(CPLGetLastErrorMsg());
}

OGRSpatialReference crs_of(const std::string& text) {
  OGRSpatialReference crs;
  require(crs.SetFromUserInput(text.c_str()) == OGRERR_NONE);
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

void write_pixels(GDALRasterBand& band, const TestRaster& raster,
                  const std::function<double(int, int)>& value) {
  std::vector<double> line(static_cast<std::size_t>(raster.cols));
  for (int row = 0; row < raster.rows; ++row) {
    for (int col = 0; col < raster.cols; ++col) line[static_cast<std::size_t>(col)] = value(col, row);
    require(band.RasterIO(GF_Write, 0, row, raster.cols, 1, line.data(), raster.cols, 1, GDT_Float64, 0, 0,
                          nullptr) == CE_None);
  }
}

}  // namespace

void write_geotiff(const std::string& path, const TestRaster& raster) {
  GDALRegister_GTiff();
  CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  const char* const signed_bytes[] = {"PIXELTYPE=SIGNEDBYTE", nullptr};
  const bool is_signed_byte = raster.type == "SignedByte";
  const GDALDatasetUniquePtr dataset(
      driver->Create(path.c_str(), raster.cols, raster.rows, 1,
                     is_signed_byte ? GDT_Byte : GDALGetDataTypeByName(raster.type.c_str()),
                     is_signed_byte ? const_cast<char**>(signed_bytes) : nullptr));
  require(dataset != nullptr);
  if (!raster.crs.empty()) {
    const OGRSpatialReference crs = crs_of(raster.crs);
    require(dataset->SetSpatialRef(&crs) == CE_None);
  }
  if (raster.transform) {
    std::array<double, 6> coefficients = *raster.transform;
    require(dataset->SetGeoTransform(coefficients.data()) == CE_None);
  }
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  if (raster.nodata) require(band.SetNoDataValue(*raster.nodata) == CE_None);
  if (raster.scale != 1) require(band.SetScale(raster.scale) == CE_None);
  if (raster.offset != 0) require(band.SetOffset(raster.offset) == CE_None);
  if (!raster.unit.empty()) require(band.SetUnitType(raster.unit.c_str()) == CE_None);
  if (raster.valid) {
    require(dataset->CreateMaskBand(GMF_PER_DATASET) == CE_None);
    write_pixels(*band.GetMaskBand(), raster, [&](int c, int r) { return raster.valid(c, r) ? 255 : 0; });
  }
  write_pixels(band, raster, raster.value);
}

std::vector<MapPoint> site_to_crs(const std::string& site_wkt, const std::vector<SitePoint>& points,
                                  const std::string& crs) {
  const OGRSpatialReference from = crs_of(site_wkt);
  const OGRSpatialReference to = crs_of(crs);
  const std::unique_ptr<OGRCoordinateTransformation> transformation(
      OGRCreateCoordinateTransformation(&from, &to));
  require(transformation != nullptr);
  std::vector<MapPoint> result;
  for (const SitePoint& point : points) {
    MapPoint& map_point = result.emplace_back(MapPoint{point.x_m, point.y_m});
    require(transformation->Transform(1, &map_point.x, &map_point.y) != 0);
  }
  return result;
}

MapPoint site_to_crs(const std::string& site_wkt, const SitePoint& point, const std::string& crs) {
  return site_to_crs(site_wkt, std::vector<SitePoint>{point}, crs).front();
}

bool is_local_in_metres(const std::string& wkt) {
  const OGRSpatialReference crs = crs_of(wkt);
  return crs.IsLocal() != 0 && crs.GetLinearUnits() == 1;
}

}  // namespace landfall
