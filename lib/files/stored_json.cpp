// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/stored_json.h"

#include "base/json_levels.h"

namespace landfall {

bool is_storable_json(const std::string& text) {
  JsonLevels levels(kMaxStoredLevels);
  return nlohmann::json::sax_parse(text, &levels);
}

}  // namespace landfall
