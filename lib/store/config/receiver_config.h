// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "chain/lidar/detector/detector.h"
#include "chain/lidar/receiver/range_timer.h"
#include "chain/lidar/receiver/receiver.h"
#include "store/config/scan_components.h"

namespace landfall {

/// Each takes a whole resolved scan configuration, because a receiver depends on several sections: its own,
/// the beam, the surface, the link, and the range gate of the noise. All throw UsageError "section/key: ...".
[[nodiscard]] Receiver make_receiver(const nlohmann::json& resolved, const ComponentContext& context);
[[nodiscard]] RangeTimer make_range_timer(const nlohmann::json& resolved, const ComponentContext& context);
/// Lidar::link_constants_pe_m2.
[[nodiscard]] std::vector<double> make_link_constants(const nlohmann::json& resolved,
                                                      const Detector& detector);

/// True if the surface's albedo is the terrain's layer.
[[nodiscard]] bool uses_albedo_map(const nlohmann::json& resolved);
/// Warnings of keys that are set but have no effect with this type of receiver, and of a receiver that sees a
/// single ray of each pixel.
[[nodiscard]] std::vector<std::string> receiver_warnings(const nlohmann::json& resolved);

}  // namespace landfall
