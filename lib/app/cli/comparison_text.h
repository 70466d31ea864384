// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace landfall::cli {

/// "easting 100304.70 m, northing -50300.00 m" and "latitude 71.1234567 deg, longitude 12.3456789 deg", of
/// the keys of map_position_json() that an object has; none without any.
[[nodiscard]] std::vector<std::string> place_lines(const nlohmann::ordered_json& place);

/// The result of compare_files() as lines of text.
[[nodiscard]] std::string comparison_text(const nlohmann::ordered_json& comparison);

/// The result of describe_bin() as lines of text.
[[nodiscard]] std::string bin_text(const nlohmann::ordered_json& bin);

}  // namespace landfall::cli
