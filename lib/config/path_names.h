// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace landfall {

/// The configuration keys that name files.
inline constexpr std::array kPathKeys = {"path", "table"};

/// Removes folders from the paths of a configuration: messages and files must not reveal the machine's
/// folders.
inline void cut_paths(nlohmann::json& value) {
  for (const char* const key : kPathKeys)
    if (value.is_object() && value.contains(key) && value[key].is_string())
      value[key] = std::filesystem::path(value[key].get<std::string>()).filename().string();
  if (value.is_structured())
    for (nlohmann::json& element : value) cut_paths(element);
}

}  // namespace landfall
