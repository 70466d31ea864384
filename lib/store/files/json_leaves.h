// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace landfall {

/// A value of two configurations, or of two objects of metrics, side by side; empty where one has none.
struct ValuePair {
  std::string path;  ///< dotted: noise.range_sigma_m
  std::optional<nlohmann::ordered_json> a;
  std::optional<nlohmann::ordered_json> b;
};

/// The values of both, those of `a` first. Arrays and empty objects are values.
[[nodiscard]] std::vector<ValuePair> value_pairs(const nlohmann::ordered_json& a,
                                                 const nlohmann::ordered_json& b);

}  // namespace landfall
