// SPDX-License-Identifier: GPL-3.0-or-later
#include "lidar_host.h"

namespace lander {

landfall::lidar::Pose pose_of(const BusState& state) {
  const Vector3d& p = state.position_m;
  const Quaterniond& q = state.attitude;
  return {.position_m = {p.x(), p.y(), p.z()}, .attitude = {q.w(), q.x(), q.y(), q.z()}};
}

landfall::lidar::Pulse pulse_of(std::int64_t number, const PoseSample& poses, Knowledge knowledge) {
  const bool perfect = knowledge == Knowledge::truth;
  return {.number = number,
          .truth = pose_of(poses.truth),
          .estimate = pose_of(perfect ? poses.truth : poses.estimate),
          .nominal = pose_of(perfect ? poses.truth : poses.predicted)};
}

landfall::lidar::Intersect scene_of(const Heightfield& ground) {
  return [&ground](const landfall::lidar::Ray& ray) { return ground.range_m(ray.origin_m, ray.direction); };
}

}  // namespace lander
