// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace landfall {

/// The first text of a WKT, which is the name of the CRS; none without one.
[[nodiscard]] std::optional<std::string> name_in_wkt(const std::string& wkt);

/// The place of a site for a person (chain/terrain/site_wkt.h): `map`, the name of its CRS, `center` in units
/// of the map, `height_m` of the origin, `vertical_datum`; null where not known.
[[nodiscard]] nlohmann::ordered_json place_json(const std::string& crs_wkt);

}  // namespace landfall
