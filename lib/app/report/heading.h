// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall::html_report {

/// "mars.tif with golombek rocks, risley scanner": the site and the lidar of the steps that led to a
/// report, as far as these say; `otherwise` if they say nothing. Steps of another structure are ignored. Not
/// escaped.
[[nodiscard]] std::string title_of(const nlohmann::json& steps,
                                   const std::string& otherwise = "DEM evaluation");

/// "80 x 80 m of terrain at 5 cm; 40,000 pulses of 18 x 18 pixels at 20 kHz, from [0, 0, 300] m; bins of 5
/// cm": the same steps in numbers, without a date. Not escaped; empty if the steps say nothing.
[[nodiscard]] std::string origin_of(const nlohmann::json& steps);

}  // namespace landfall::html_report
