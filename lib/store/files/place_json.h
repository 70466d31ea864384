// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall {

/// The place of a site for a person (chain/terrain/site_wkt.h): `map`, the name of its CRS, `center` in units
/// of the map, `height_m` of the origin, `vertical_datum`; null where not known.
[[nodiscard]] nlohmann::ordered_json place_json(const std::string& crs_wkt);

}  // namespace landfall
