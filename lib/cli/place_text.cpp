// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/place_text.h"

#include <utility>

#include "cli/print.h"
#include "geometry/map_position.h"

namespace landfall::cli {

std::vector<std::string> place_lines(const nlohmann::ordered_json& place) {
  std::vector<std::string> lines;
  std::string unit;
  for (const MapCoordinate& coordinate : kMapCoordinates) {
    if (!place.contains(coordinate.key) || !place.at(coordinate.key).is_number()) continue;
    const bool is_length = std::string(coordinate.units) == "m";
    const std::string text = coordinate.column + print(is_length ? " %.2f m" : " %.7f deg",
                                                       place.at(coordinate.key).get<double>());
    const std::string of = is_length ? "m" : "deg";
    if (of == std::exchange(unit, of))
      lines.back() += ", " + text;
    else
      lines.push_back(text);
  }
  return lines;
}

}  // namespace landfall::cli
