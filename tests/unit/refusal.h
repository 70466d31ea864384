// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/core/error.h"

namespace landfall {

/// The message of the UsageError that `work` throws; "accepted" if it throws none.
template <class Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace landfall
