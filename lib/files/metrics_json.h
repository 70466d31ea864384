// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "evaluation/metrics.h"

namespace landfall {

/// metrics.json (SPEC section 6): plain numbers in a stable order, null for what is not known or not finite.
/// Without truth the structure stays and its numbers are null.
[[nodiscard]] nlohmann::ordered_json metrics_json(const Metrics& metrics);

}  // namespace landfall
