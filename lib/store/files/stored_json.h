// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/text/json_text.h"

namespace landfall {

/// More levels than any landfall file has: a configuration of at most 64 levels within a step of a history.
/// Code that walks JSON recurses once per level.
inline constexpr int kMaxStoredLevels = 100;

/// True for a text that is JSON of at most kMaxStoredLevels levels. O(size) for any depth.
[[nodiscard]] inline bool is_storable_json(const std::string& text) {
  JsonLevels levels(kMaxStoredLevels);
  return nlohmann::json::sax_parse(text, &levels);
}

/// The JSON of a text in a file; null if there is no text or is_storable_json() is false. `Json` is
/// nlohmann::json or ordered_json.
template <class Json>
[[nodiscard]] Json stored_json(const std::optional<std::string>& text) {
  return text && is_storable_json(*text) ? Json::parse(*text) : Json(nullptr);
}

}  // namespace landfall
