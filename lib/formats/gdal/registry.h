// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// Whether to offer the netCDF and HDF5 drivers, whose libraries open files without the guard
/// (file_guard.h).
enum class Unguarded { withheld, offered };

/// Makes GDAL ignore options of the environment and of its configuration files, by which the same file would
/// be another one: half a pixel aside, or in another unit. To be called before any other use of GDAL.
void ignore_gdal_options();

/// Makes GDAL ready to open `path`: its block cache bounded, its messages off stderr on every thread, and no
/// drivers but raster_drivers(), for what a raster names too: none that calls another machine or reads this
/// program's memory. Unless the path itself names a virtual file system ("/vsi") or a URL ("://"), /vsicurl/
/// and its kin open nothing.
void prepare_gdal_to_read(const std::string& path, Unguarded unguarded);
/// The same for polygons in a local file, with the drivers polygon_drivers().
void prepare_gdal_to_read_polygons();
/// The same for writing, with all drivers.
void prepare_gdal_to_write();

/// The drivers that may open a raster: file formats of elevations and images, and the VRT. The list ends with
/// null.
[[nodiscard]] const char* const* raster_drivers();

/// The drivers that may open a file of polygons. The list ends with null.
[[nodiscard]] const char* const* polygon_drivers();

/// The raster format, among those that are not in raster_drivers(), that GDAL recognises in the first bytes
/// of a local file: "FITS (Flexible Image Transport System)". Empty if it recognises none.
[[nodiscard]] std::string unread_format(const std::string& path);

}  // namespace landfall
