// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "chain/terrain/populations/patterns.h"

namespace landfall {

/// The arguments are parts of a resolved terrain configuration; "type" is one of the schema's.
[[nodiscard]] FeatureShape feature_shape(const nlohmann::json& feature);
[[nodiscard]] Feature placed_feature(const nlohmann::json& feature);
/// `owner` ("patterns/3") begins the message of the UsageError for keys that are mutually exclusive.
[[nodiscard]] FeaturePattern feature_pattern(const nlohmann::json& pattern, const std::string& owner);

}  // namespace landfall
