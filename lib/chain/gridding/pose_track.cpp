// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/pose_track.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/core/error.h"

namespace landfall {
namespace {

constexpr std::size_t kMaxTrackPoses = 16384;

void check_poses(const ScanPoses& scan) {
  if (scan.t_s.empty() || scan.t_s.size() != scan.position_m.size() ||
      scan.t_s.size() != scan.attitude.size())
    throw FormatError(scan.name + ": /pulses holds no poses, or columns of different lengths");
  for (std::size_t i = 0; i < scan.t_s.size(); ++i) {
    const Eigen::Vector4d q = scan.attitude[i].coeffs();
    if (!std::isfinite(scan.t_s[i]) || !scan.position_m[i].allFinite() || !q.allFinite() || q.norm() == 0)
      throw FormatError(scan.name + ": a pose in /pulses is not finite");
    if (i > 0 && scan.t_s[i] < scan.t_s[i - 1])
      throw FormatError(scan.name + ": the times in /pulses are not ascending");
  }
}

}  // namespace

ScanPoses estimated_poses(std::string name, const PulseColumns& pulses) {
  ScanPoses poses{std::move(name), {}, {}, {}};
  const std::size_t count = pulses.t.size();
  const std::size_t stride = (count + kMaxTrackPoses - 1) / kMaxTrackPoses;
  const auto keep = [&](std::size_t i) {
    poses.t_s.push_back(pulses.t[i]);
    poses.position_m.emplace_back(pulses.px_est[i], pulses.py_est[i], pulses.pz_est[i]);
    poses.attitude.emplace_back(pulses.qw_est[i], pulses.qx_est[i], pulses.qy_est[i], pulses.qz_est[i]);
  };
  for (std::size_t i = 0; i < count; i += stride) keep(i);
  if (count > 0 && (count - 1) % stride != 0) keep(count - 1);
  return poses;
}

bool operator==(const ScanPoses& a, const ScanPoses& b) {
  return a.t_s == b.t_s && a.position_m == b.position_m &&
         std::equal(a.attitude.begin(), a.attitude.end(), b.attitude.begin(), b.attitude.end(),
                    [](const Eigen::Quaterniond& p, const Eigen::Quaterniond& q) {
                      return p.coeffs() == q.coeffs();
                    });
}

PoseTrack::PoseTrack(std::vector<ScanPoses> scans) {
  assert(!scans.empty());
  for (const ScanPoses& scan : scans) check_poses(scan);
  std::stable_sort(scans.begin(), scans.end(),
                   [](const ScanPoses& a, const ScanPoses& b) { return a.t_s.front() < b.t_s.front(); });
  for (ScanPoses& scan : scans) {
    if (!scans_.empty() && scan == scans_.back()) continue;
    if (!scans_.empty() && scan.t_s.front() <= scans_.back().t_s.back())
      throw UsageError(
          scan.name + " overlaps " + scans_.back().name +
          " in time with other poses; grid scans that follow one another, or repeat the same poses");
    scans_.push_back(std::move(scan));
  }
}

TimedPose PoseTrack::at(double t_s) const {
  auto later = std::upper_bound(scans_.begin(), scans_.end(), t_s,
                                [](double t, const ScanPoses& scan) { return t < scan.t_s.front(); });
  const ScanPoses& scan = later == scans_.begin() ? scans_.front() : *(later - 1);
  const double t = std::clamp(t_s, scan.t_s.front(), scan.t_s.back());
  const auto after = std::upper_bound(scan.t_s.begin(), scan.t_s.end(), t);
  const auto next = static_cast<std::size_t>(std::min(after, scan.t_s.end() - 1) - scan.t_s.begin());
  const std::size_t last = next == 0 ? 0 : next - 1;
  const double span = scan.t_s[next] - scan.t_s[last];
  const double u = span > 0 ? (t - scan.t_s[last]) / span : 1;  // 0: the last of several poses at one time
  const Eigen::Vector4d from = scan.attitude[last].coeffs();
  Eigen::Vector4d to = scan.attitude[next].coeffs();
  if (from.dot(to) < 0) to = -to;  // the same attitude, so that the interpolation takes the short way
  const Eigen::Quaterniond attitude(Eigen::Vector4d((1 - u) * from + u * to).normalized());
  return {Point<DemFrame>{(1 - u) * scan.position_m[last] + u * scan.position_m[next]},
          Rotation<DemFrame, BodyFrame>{attitude.toRotationMatrix()}, t - scan.t_s.front()};
}

}  // namespace landfall
