// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/error.h"

namespace landfall {

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
