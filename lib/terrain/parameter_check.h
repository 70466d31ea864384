// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include "base/error.h"

namespace landfall {

/// A parameter by its place in the model ("features/3") and its key, for messages.
struct ParameterName {
  std::string owner;
  const char* key = "";
};

/// Throws UsageError naming the parameter, its value and the bound unless `holds`.
inline void require(bool holds, const ParameterName& name, double value, const char* bound) {
  if (holds) return;
  std::ostringstream message;
  message.precision(17);
  message << name.owner << "/" << name.key << ": " << value << " is not " << bound;
  throw UsageError(message.str());
}

inline void require_positive(const ParameterName& name, double value) {
  require(std::isfinite(value) && value > 0, name, value, "finite and positive");
}

inline void require_finite(const ParameterName& name, double value) {
  require(std::isfinite(value), name, value, "finite");
}

}  // namespace landfall
