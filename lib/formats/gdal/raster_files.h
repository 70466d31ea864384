// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// The files that a raster's name itself refers to: the name, and those inside a name such as NETCDF:"f.nc":z
/// or /vsizip/f.zip/a.tif. Names of files that do not exist are omitted. Opens no file.
[[nodiscard]] std::vector<std::string> own_files(const std::string& path);

/// own_files(), and with RasterLinks::followed also those that VRTs among them name, at any depth. Opens VRTs
/// only.
[[nodiscard]] std::vector<std::string> named_files(const std::string& path, RasterLinks links);

/// True where one of the files has the signature of HDF5 or netCDF.
[[nodiscard]] bool any_hdf5_or_netcdf(const std::vector<std::string>& files);

/// GDAL's side of dem_files() (lib/formats/gdal/gdal_loader.h).
[[nodiscard]] std::vector<std::string> all_dem_files(const DemBase& dem, RasterLinks links);

}  // namespace landfall
