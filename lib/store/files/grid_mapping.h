// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace landfall {

/// The attributes of a CF grid mapping variable (CF-1.8, section 5.6 and appendix F) besides crs_wkt.
struct GridMapping {
  std::vector<std::pair<std::string, std::string>> texts;            ///< grid_mapping_name and names of parts
  std::vector<std::pair<std::string, std::vector<double>>> numbers;  ///< degrees and metres; 1 or 2 values
};

/// The grid mapping of a projected CRS in metres, given as WKT2. Nothing where CF-1.8 has no such projection
/// (equirectangular, oblique mercator with a rotated grid, ...) or no parameter for one of its values, and
/// for any other text.
[[nodiscard]] std::optional<GridMapping> grid_mapping_of(const std::string& wkt);

/// True for a local (engineering) CRS, which is not tied to a body: CF has no grid mapping for it and needs
/// none.
[[nodiscard]] bool is_local_crs(const std::string& wkt);

}  // namespace landfall
