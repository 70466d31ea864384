// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace landfall {

/// The name by which GDAL opens one array of an HDF5 file: NETCDF:"f.h5":z. None for a path with a double
/// quote, which such a name cannot hold in any spelling (GDAL 3.6).
[[nodiscard]] inline std::optional<std::string> netcdf_name(const std::string& path,
                                                            const std::string& array) {
  if (path.find('"') != std::string::npos) return std::nullopt;
  return "NETCDF:\"" + path + "\":" + array;
}

inline constexpr const char* kNoNetcdfName =
    "GDAL opens no layer of a file whose path has a double quote; rename it";

}  // namespace landfall
