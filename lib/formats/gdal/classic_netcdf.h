// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// Throws FormatError if a netCDF file of the classic formats (CDF-1, CDF-2) is shorter than its header says,
/// since the netCDF library reads missing data as zeros. Does nothing for any other file or if the header
/// itself is damaged, which the library rejects.
void require_whole_classic_netcdf(const std::string& path);

}  // namespace landfall
