// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ogr_spatialref.h>

#include <optional>
#include <string>

#include "formats/gdal/point_frame.h"

namespace landfall {

/// The CRS of points, axes in longitude-latitude or easting-northing order, and the size of a unit of their
/// heights where one is declared. Opens no file and no connection.
struct ReadCrs {
  OGRSpatialReference crs;
  std::optional<double> metres_per_height = std::nullopt;
  std::string vertical = {};  ///< name of the datum of the heights; empty: not known
  std::string replaced = {};  ///< the name of the file's CRS where an option gives another one
};

/// The CRS of a text that a user gives, axes as above. Opens no file and no connection. Throws UsageError,
/// which begins with `name`, for one that GDAL does not know.
[[nodiscard]] OGRSpatialReference crs_of_text(const std::string& text, const std::string& name);

/// Throws UsageError for an `option` that GDAL does not know, FormatError for a CRS of the file that it
/// cannot read; `name` begins messages.
[[nodiscard]] ReadCrs read_point_crs(const PointCrs& points, const std::string& name);

}  // namespace landfall
