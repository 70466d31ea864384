// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <landfall/lidar.h>

#include "flight.h"
#include "heightfield.h"

namespace lander {

/// The pose that the lidar's data processing takes.
enum class Knowledge { filter, truth };

[[nodiscard]] landfall::lidar::Pose pose_of(const BusState& state);

/// Pulse `number` at these poses. The mirror is aimed by the predicted pose, the points are computed from the
/// estimate; with Knowledge::truth, both by the true one.
[[nodiscard]] landfall::lidar::Pulse pulse_of(std::int64_t number, const PoseSample& poses,
                                              Knowledge knowledge);

/// landfall's callback for the scene, which must outlive it.
[[nodiscard]] landfall::lidar::Intersect scene_of(const Heightfield& ground);

}  // namespace lander
