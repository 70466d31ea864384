// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace landfall {

/// More levels than any file of ours has: a configuration, 64 at the most, within a step of a history. What
/// walks JSON calls itself level by level.
inline constexpr int kMaxStoredLevels = 100;

/// True for a text that is JSON of at most kMaxStoredLevels levels. O(size), whatever its depth.
[[nodiscard]] bool is_storable_json(const std::string& text);

/// The JSON of a text in a file; null where there is no text or is_storable_json() does not hold. `Json` is
/// nlohmann::json or ordered_json.
template <class Json>
[[nodiscard]] Json stored_json(const std::optional<std::string>& text) {
  return text && is_storable_json(*text) ? Json::parse(*text) : Json(nullptr);
}

}  // namespace landfall
