// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace landfall {

/// The configuration keys that name files.
inline constexpr std::array kPathKeys = {"path", "table"};

/// Replaces each path of a configuration by change(path).
template <class Change>
void change_paths(nlohmann::json& value, const Change& change) {
  for (const char* const key : kPathKeys)
    if (value.is_object() && value.contains(key) && value[key].is_string())
      value[key] = change(std::filesystem::path(value[key].template get<std::string>())).string();
  if (value.is_structured())
    for (nlohmann::json& element : value) change_paths(element, change);
}

/// Removes folders from the paths of a configuration: messages and files must not reveal the machine's
/// folders.
inline void cut_paths(nlohmann::json& value) {
  change_paths(value, [](const std::filesystem::path& path) { return path.filename(); });
}

}  // namespace landfall
