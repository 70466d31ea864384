// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/stored_json.h"

#include "base/json_levels.h"

namespace landfall {

bool is_storable_json(const std::string& text) {
  JsonLevels levels(kMostStoredLevels);
  return nlohmann::json::sax_parse(text, &levels);
}

}  // namespace landfall
