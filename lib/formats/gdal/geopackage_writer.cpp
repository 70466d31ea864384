// SPDX-License-Identifier: GPL-3.0-or-later
#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <cstddef>

#include "base/core/error.h"
#include "formats/gdal/gdal_crs.h"
#include "formats/gdal/gdal_errors.h"
#include "formats/gdal/plugin.h"
#include "formats/gdal/registry.h"

namespace landfall {
namespace {

OGRErr write_point(OGRLayer& target, const PointLayer& layer, std::size_t i) {
  OGRFeature feature(target.GetLayerDefn());
  for (std::size_t c = 0; c < layer.columns.size(); ++c) {
    const PointLayer::Column& column = layer.columns[c];
    const int field = static_cast<int>(c);
    if (std::isnan(column.values[i]))
      feature.SetFieldNull(field);
    else if (column.is_integer)
      feature.SetField(field, static_cast<GIntBig>(column.values[i]));
    else
      feature.SetField(field, column.values[i]);
  }
  const OGRPoint point(layer.x_m[i], layer.y_m[i], layer.z_m[i]);
  feature.SetGeometry(&point);
  return target.CreateFeature(&feature);
}

bool write_layer(GDALDataset& file, const PointLayer& layer) {
  OGRSpatialReference crs = crs_to_export(layer.crs_wkt);
  OGRLayer* const target = file.CreateLayer(layer.name.c_str(), &crs, wkbPoint25D);
  if (target == nullptr) return false;
  for (const PointLayer::Column& column : layer.columns) {
    OGRFieldDefn field(column.name.c_str(), column.is_integer ? OFTInteger : OFTReal);
    if (target->CreateField(&field) != OGRERR_NONE) return false;
  }
  for (std::size_t i = 0; i < layer.x_m.size(); ++i)
    if (write_point(*target, layer, i) != OGRERR_NONE) return false;
  return true;
}

}  // namespace

void write_geopackage_points(const std::string& path, const PointLayer& layer) {
  prepare_gdal_to_write();
  GdalErrors errors;
  GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  if (driver == nullptr) throw IoError("this GDAL has no GeoPackage driver");
  // The time of the last change is part of the format; equal sites give equal bytes.
  const CPLConfigOptionSetter no_clock("OGR_CURRENT_DATE", "1970-01-01T00:00:00.000Z", false);
  // The whole file is temporary until it is complete; a journal next to it could be left behind.
  const CPLConfigOptionSetter no_journal("OGR_SQLITE_JOURNAL", "OFF", false);
  VSIUnlink(path.c_str());  // the driver refuses a file that exists, also an empty one
  GDALDatasetUniquePtr file(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  const bool is_written = file != nullptr && write_layer(*file, layer);
  file.reset();  // flushes, so that errors are known
  if (!is_written || errors.any()) throw IoError("writing failed: " + errors.reason());
}

}  // namespace landfall
