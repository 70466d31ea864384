// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace landfall {

/// Stores 60, not 60.0, as a user would write it: the text of a configuration is part of file_id.
inline nlohmann::json plain_number(double number) {
  if (number == std::floor(number) && std::abs(number) < 0x1p53) return static_cast<std::int64_t>(number);
  return number;
}

}  // namespace landfall
