// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/landfall_file.h"
#include "gridding/pose_track.h"

namespace landfall {

/// The estimated poses of a scan's /pulses, thinned evenly to at most 16,385 (every 0.12 ms of a 2 s scan),
/// the first and the last among them: memory does not grow with the pulses, but for one column at a time.
/// Throws FormatError where a column is missing or columns differ in length.
[[nodiscard]] ScanPoses read_scan_poses(const LandfallFileReader& scan);

}  // namespace landfall
