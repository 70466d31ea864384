// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall {

/// For libraries that link nlohmann_json. Whether a text is UTF-8, which JSON requires.
inline bool is_utf8(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

/// Replaces each byte that is not UTF-8 by U+FFFD.
inline std::string as_utf8(const std::string& text) {
  if (is_utf8(text)) return text;
  const std::string json =
      nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return nlohmann::json::parse(json).get<std::string>();
}

}  // namespace landfall
