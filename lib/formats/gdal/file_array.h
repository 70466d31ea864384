// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "formats/gdal/open_raster.h"

namespace landfall {

/// One dimension of the array under a raster, and its coordinate variable.
struct FileAxis {
  std::string name;            ///< of the dimension
  std::string unit;            ///< as the file spells it; empty: none
  bool is_northing = false;    ///< by its attributes (axis, standard_name) or its name
  bool is_easting = false;     ///< by its attributes or its name
  std::vector<double> values;  ///< unpacked; empty: no coordinate variable
  double rounding = 0;         ///< half a step of the stored type at the largest value, unpacked
};

/// A range of valid samples.
struct ValidRange {
  double low;
  double high;
  bool unpacked = false;  ///< holds after scale and offset, else before
};

/// The statements of a netCDF or HDF5 file on a raster, in addition to GDAL's reading of them.
struct FileArray {
  std::string name;
  FileAxis columns;
  FileAxis rows;
  bool rows_reversed = false;  ///< the raster's first row is the array's last
  std::string unit;
  std::optional<double> scale;
  std::optional<double> offset;
  std::vector<double> fills;  ///< _FillValue and missing_value, packed
  std::optional<ValidRange> valid;
  bool downwards = false;  ///< positive: down, or a standard_name of a depth
};

/// The array under a netCDF or HDF5 raster; none for rasters of other formats and for arrays that GDAL's
/// multidimensional drivers do not describe. Reads coordinate variables and a few rows. Throws FormatError
/// where the rows that GDAL reads are not rows of the array.
[[nodiscard]] std::optional<FileArray> file_array(const OpenRaster& raster, const DemBase& dem);

/// The georeference by coordinate variables, which must be evenly spaced, to pixel edges; in the units of the
/// variables. None if one of them is missing. Throws FormatError naming the variable and the values where one
/// is not finite, not monotonic, or has a gap of more than a thousandth of a pixel beyond its rounding.
[[nodiscard]] std::optional<std::array<double, 6>> axes_transform(const FileArray& array, const DemBase& dem);

}  // namespace landfall
