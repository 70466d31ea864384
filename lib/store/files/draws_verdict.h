// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "chain/draws/draw_table.h"
#include "chain/draws/sprt.h"

namespace landfall {

/// How many draws passed each requirement and all six ("all"), then each of the user's own and these and the
/// six together ("all_and_own"), with Wilson's 95 % interval and the exact one-sided
/// lower bound, and in how many it is judged; of a campaign that judges hazards also in how many the chosen
/// place is safe in truth, and of one whose draws land in how many they land safely, with the lidar and
/// without, with exact McNemar test and the interval of the difference (Newcombe). Over several scans for
/// each of them, and for all. With the state of a sequential test the results decided the number of draws:
/// both are then not valid, and marked so.
[[nodiscard]] nlohmann::ordered_json verdict_json(const DrawTable& table,
                                                  const std::optional<SprtState>& sprt);

}  // namespace landfall
