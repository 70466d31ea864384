// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/core/error.h"

namespace landfall {

/// The message of the exception of type `Refusal` that `work` throws; "accepted" if it throws none.
template <class Refusal = UsageError, class Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const Refusal& error) {
    return error.what();
  }
  return "accepted";
}

/// The message of the Error that `work` throws, after its kind: "usage: " or "format: ".
template <class Work>
std::string kind_and_refusal(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return (error.exit_code() == ExitCode::usage ? "usage: " : "format: ") + std::string(error.what());
  }
  return "accepted";
}

}  // namespace landfall
