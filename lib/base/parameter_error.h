// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// The parameter whose value would resolve an error, as the throwing module names it: "half_width_m".
struct SettlingParameter {
  const char* name;  ///< a string literal
};

/// A UsageError or FormatError with such a parameter; the tool adds the option that sets it to the message.
template <class Kind>
struct ParameterError final : Kind, SettlingParameter {
  ParameterError(const std::string& message, const char* parameter)
      : Kind(message), SettlingParameter{parameter} {}
};

}  // namespace landfall
