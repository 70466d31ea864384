// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace landfall {

/// The remark in the WKT of a site frame that names the CRS of the site's map
/// (lib/terrain/gdal/map_position.h).
inline constexpr std::string_view kMapRemark = ",REMARK[\"map: ";

/// The site frame alone.
[[nodiscard]] inline std::string without_map(const std::string& site_wkt) {
  const std::size_t begin = site_wkt.rfind(kMapRemark);
  return begin == std::string::npos ? site_wkt : site_wkt.substr(0, begin) + "]";
}

}  // namespace landfall
