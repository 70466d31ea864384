// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "terrain/features/feature.h"

namespace landfall {

/// Parts of a resolved terrain configuration, whose "type" is one of the schema's.
[[nodiscard]] FeatureShape feature_shape(const nlohmann::json& feature);
[[nodiscard]] Feature placed_feature(const nlohmann::json& feature);
[[nodiscard]] FeaturePattern feature_pattern(const nlohmann::json& pattern);

}  // namespace landfall
