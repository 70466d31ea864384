// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace landfall {

/// The unit that the name of a key ends in: "m/s" of "velocity_mps", "1/s" of "rate_per_s". Empty if it ends
/// in none.
[[nodiscard]] std::string_view unit_of_key(std::string_view name);

}  // namespace landfall
