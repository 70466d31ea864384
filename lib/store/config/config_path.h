// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <string>

#include "base/core/error.h"

namespace landfall {

/// Whether a key can be the index of an array: digits only.
[[nodiscard]] inline bool is_index(const std::string& key) {
  return !key.empty() && std::ranges::all_of(key, [](char c) { return c >= '0' && c <= '9'; });
}

/// Calls work(). Its UsageErrors begin with a parameter name; this prefixes the name with its path in the
/// configuration: "scan.json: /", "noise/".
template <class Work>
auto at_path(const std::string& path, const Work& work) {
  try {
    return work();
  } catch (const UsageError& error) {
    throw UsageError(path + error.what());
  }
}

}  // namespace landfall
