// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/place_json.h"

#include "chain/terrain/site_wkt.h"
#include "store/files/field_json.h"
#include "store/files/grid_mapping.h"

namespace landfall {

std::optional<std::string> name_in_wkt(const std::string& wkt) {
  const std::size_t begin = wkt.find('"');
  const std::size_t end = begin == std::string::npos ? begin : wkt.find('"', begin + 1);
  return end == std::string::npos ? std::nullopt : std::optional(wkt.substr(begin + 1, end - begin - 1));
}

nlohmann::ordered_json place_json(const std::string& crs_wkt) {
  using OrderedJson = nlohmann::ordered_json;
  const MapPlace place = place_of(crs_wkt).value_or(unplaced(crs_wkt));
  OrderedJson json;
  json["map"] =
      or_null(name_in_wkt(place.map_wkt.empty() && !is_local_crs(crs_wkt) ? crs_wkt : place.map_wkt));
  json["center"] = {finite_json(place.center[0]), finite_json(place.center[1])};
  json["height_m"] = finite_json(place.center[2]);
  json["vertical_datum"] = place.vertical.empty() ? OrderedJson() : OrderedJson(place.vertical);
  return json;
}

}  // namespace landfall
