// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ogr_spatialref.h>

#include <string>

#include "base/core/error.h"
#include "formats/gdal/gdal_errors.h"
#include "formats/gdal/known_crs.h"

namespace landfall {

/// The frame of a file that is exported. Throws FormatError unless the text is one, and without PROJ's
/// database, which GDAL needs to write it; an empty text gives none.
inline OGRSpatialReference crs_to_export(const std::string& wkt) {
  OGRSpatialReference crs;
  if (wkt.empty()) return crs;
  GdalErrors errors;
  if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE)
    throw FormatError("/crs: its attribute crs_wkt is not a coordinate reference system" +
                      (errors.any() ? ": " + errors.reason() : std::string()));
  require_crs_database("/crs");
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

}  // namespace landfall
