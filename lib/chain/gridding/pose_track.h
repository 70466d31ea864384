// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "base/geometry/frames.h"
#include "base/returns/columns.h"

namespace landfall {

/// The lander's estimated poses at some pulses of a scan, times ascending.
struct ScanPoses {
  std::string name;  ///< of the scan, for error messages
  std::vector<double> t_s;
  std::vector<Eigen::Vector3d> position_m;   ///< of the body's origin, frame D
  std::vector<Eigen::Quaterniond> attitude;  ///< D <- B
  friend bool operator==(const ScanPoses&, const ScanPoses&);
};

/// The estimated poses of a scan's pulses: at most 16,384 at equal steps, and the last one. The columns of
/// times and estimated poses have one length.
[[nodiscard]] ScanPoses estimated_poses(std::string name, const PulseColumns& pulses);

/// A pose and the time since its scan began.
struct TimedPose {
  Point<DemFrame> position;
  Rotation<DemFrame, BodyFrame> attitude;
  double since_start_s = 0;
};

/// The pose at any time of one scan, or of several scans that follow each other.
class PoseTrack {
 public:
  /// At least one scan. Scans with the same poses at the same times count as one. Throws FormatError, naming
  /// the scan, where a scan has no pose, times that are not finite and ascending, or a pose that is not
  /// finite; UsageError where two scans overlap in time with different poses: a time would have two poses.
  explicit PoseTrack(std::vector<ScanPoses> scans);

  /// Position by linear and attitude by normalised linear interpolation between the poses around t, in the
  /// last scan that has begun by then; constant before the first and after the last pose.
  [[nodiscard]] TimedPose at(double t_s) const;

 private:
  std::vector<ScanPoses> scans_;  ///< by time
};

}  // namespace landfall
