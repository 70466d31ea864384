// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "base/geometry/map_position.h"

namespace landfall {

/// The coordinates that a position has: easting_m, northing_m, latitude_deg, longitude_deg.
[[nodiscard]] inline nlohmann::ordered_json map_position_json(const MapPosition& position) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const MapCoordinate& coordinate : kMapCoordinates)
    if (const auto& value = position.*coordinate.value) json[coordinate.key] = *value;
  return json;
}

}  // namespace landfall
