// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/scan_file.h"
#include "gridding/pose_track.h"

namespace landfall {

/// The estimated poses of a scan's /pulses, with the reader's times, evenly reduced to at most 16,385 (every
/// 0.12 ms of a 2 s scan), including the first and the last. Apart from one column at a time, memory does not
/// grow with the pulses. Throws FormatError if a column is missing or columns differ in length.
[[nodiscard]] ScanPoses read_scan_poses(const ScanReader& scan);

}  // namespace landfall
