// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// Throws FormatError where a netCDF file of the classic formats (CDF-1, CDF-2) is shorter than its
/// header says: the netCDF library reads what is missing as zeros. Does nothing for any other file, nor where
/// the header itself is damaged: the library refuses that.
void require_whole_classic_netcdf(const std::string& path);

}  // namespace landfall
