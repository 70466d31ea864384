// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "terrain/terrain_model.h"

namespace landfall {

/// The files that a raster's name leads to before GDAL opens any: the name itself, those inside a name such
/// as NETCDF:"f.nc":z or /vsizip/f.zip/a.tif, and those that VRTs among them name, at any depth. A name that
/// is no existing file is left out.
[[nodiscard]] std::vector<std::string> named_files(const std::string& path);

/// GDAL's side of dem_files() (lib/terrain/gdal_loader.h).
[[nodiscard]] std::vector<std::string> all_dem_files(const DemBase& dem);

}  // namespace landfall
