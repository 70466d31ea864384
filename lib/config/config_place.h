// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/error.h"

namespace landfall {

/// Calls work(). Its UsageErrors begin with a parameter of its own; here they get the place of that in the
/// configuration: "scan.json: /", "noise/".
template <class Work>
auto at_place(const std::string& place, const Work& work) {
  try {
    return work();
  } catch (const UsageError& error) {
    throw UsageError(place + error.what());
  }
}

}  // namespace landfall
