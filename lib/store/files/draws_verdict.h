// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "chain/draws/draw_table.h"
#include "chain/draws/sprt.h"

namespace landfall {

/// The rates of the draws, each with its passed and judged draws, Wilson's 95 % interval and the exact
/// one-sided lower bound, over all scans and over each of several:
/// - each requirement, all six ("all"), each custom one, and all of them ("all_and_own");
/// - with hazards, a chosen place that is safe in truth;
/// - with landings, a safe one with and without the lidar, the exact McNemar test and Newcombe's interval of
///   the difference.
/// After a sequential test, which lets results decide the number of draws, both intervals are marked invalid.
[[nodiscard]] nlohmann::ordered_json verdict_json(const DrawTable& table,
                                                  const std::optional<SprtState>& sprt);

}  // namespace landfall
