// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include <string>

#include "base/core/error.h"
#include "base/text/number_text.h"

namespace landfall {

/// A parameter: its owner's path in the configuration ("features/3", "scanner"; may be empty) and its key.
struct ParameterName {
  std::string owner;
  std::string key;
};

/// Throws UsageError "owner/key: value is not bound" unless `holds`.
inline void require(bool holds, const ParameterName& name, double value, const char* bound) {
  if (holds) return;
  throw UsageError(name.owner + (name.owner.empty() ? "" : "/") + name.key + ": " + number_text(value) +
                   " is not " + bound);
}

inline void require_positive(const ParameterName& name, double value) {
  require(std::isfinite(value) && value > 0, name, value, "finite and positive");
}

inline void require_not_negative(const ParameterName& name, double value) {
  require(std::isfinite(value) && value >= 0, name, value, "finite and >= 0");
}

inline void require_fraction(const ParameterName& name, double value) {
  require(value >= 0 && value <= 1, name, value, "in [0, 1]");
}

inline void require_finite(const ParameterName& name, double value) {
  require(std::isfinite(value), name, value, "finite");
}

}  // namespace landfall
