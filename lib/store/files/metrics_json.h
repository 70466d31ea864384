// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "chain/evaluation/metrics.h"

namespace landfall {

/// metrics.json (docs/user/files/metrics.md): plain numbers in a stable order, null if unknown or not finite.
/// Without truth the structure is the same and its numbers are null.
[[nodiscard]] nlohmann::ordered_json metrics_json(const Metrics& metrics);

/// [{"requirement", "measured", "limit", "verdict"}], the texts of verdict_texts().
[[nodiscard]] nlohmann::ordered_json verdict_json(const Metrics& metrics, const EvaluationLimits& limits);

/// The verdicts under the key own_requirements of metrics.json or score.json; none without it. Throws
/// nlohmann::json::exception as metrics_from() does.
[[nodiscard]] RequirementVerdicts own_verdicts_from(const nlohmann::ordered_json& result);

/// The metrics of a file. Throws nlohmann::json::exception if a key is missing or has another type; an
/// unknown shape of the region is read as a circle.
[[nodiscard]] Metrics metrics_from(const nlohmann::ordered_json& json);

}  // namespace landfall
