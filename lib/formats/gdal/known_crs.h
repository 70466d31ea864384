// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ogr_spatialref.h>

#include <string>

#include "formats/gdal/gdal_errors.h"

namespace landfall {

/// Throws FormatError, which begins with `name` and names the variables that decide, unless PROJ can use its
/// database: GDAL reads a CRS without it, but with other units, names and datum shifts.
void require_crs_database(const std::string& name);

/// The same, and FormatError where reading the CRS of a file met a code that the database lacks, for which
/// GDAL takes a local CRS in metres, or one of heights alone. `remedy` ends the message.
void require_known_crs(const OGRSpatialReference* crs, const std::string& name, const GdalErrors& errors,
                       const std::string& remedy);

[[nodiscard]] inline bool is_vertical_only(const OGRSpatialReference& crs) {
  return crs.IsVertical() != 0 && crs.IsCompound() == 0;
}

}  // namespace landfall
