// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// The parameter that would settle an error, by its name in the module that throws: "half_width_m".
struct SettlingParameter {
  const char* name;  ///< a literal
};

/// A UsageError or FormatError with such a parameter; a tool adds the option that sets it.
template <class Kind>
struct ParameterError final : Kind, SettlingParameter {
  ParameterError(const std::string& message, const char* parameter)
      : Kind(message), SettlingParameter{parameter} {}
};

}  // namespace landfall
