// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "geometry/frames.h"

namespace landfall {

/// Where the lander believed to be while it scanned: the poses of some pulses, times ascending.
struct ScanPoses {
  std::string name;  ///< of the scan, for messages
  std::vector<double> t_s;
  std::vector<Eigen::Vector3d> position_m;   ///< of the body's origin, frame D
  std::vector<Eigen::Quaterniond> attitude;  ///< D <- B
  friend bool operator==(const ScanPoses&, const ScanPoses&);
};

/// A pose, and how long its scan had run.
struct TimedPose {
  Point<DemFrame> position;
  Rotation<DemFrame, BodyFrame> attitude;
  double since_start_s = 0;
};

/// The pose at any time of one scan, or of several that follow one another.
class PoseTrack {
 public:
  /// At least one scan. Scans with the same poses at the same times count as one. Throws FormatError, naming
  /// the scan, where a scan has no pose, times that are not finite and ascending, or a pose that is not
  /// finite; UsageError where two scans overlap in time with different poses: one time would have two poses.
  explicit PoseTrack(std::vector<ScanPoses> scans);

  /// Position linear, attitude by normalised linear interpolation between the poses around t, in the last
  /// scan that had begun by then; held before the first and after the last pose.
  [[nodiscard]] TimedPose at(double t_s) const;

 private:
  std::vector<ScanPoses> scans_;  ///< by time
};

}  // namespace landfall
