// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "chain/gridding/method.h"
#include "chain/gridding/pose_track.h"
#include "chain/gridding/uncertainty.h"
#include "store/files/meeting.h"
#include "store/files/scan_file.h"
#include "store/files/terrain_file.h"

namespace landfall {

/// The estimated poses of a scan's /pulses, with the reader's times, evenly reduced to at most 16,385 (every
/// 0.12 ms of a 2 s scan), including the first and the last. Apart from one column at a time, memory does not
/// grow with the pulses. Throws FormatError if a column is missing or columns differ in length.
[[nodiscard]] ScanPoses read_scan_poses(const ScanReader& scan);

using Scans = std::vector<std::unique_ptr<ScanReader>>;

/// Opens scans, and adds them to the inputs of the output. All count their times from the
/// earliest of their first pulses.
[[nodiscard]] Scans open_scans(const std::vector<std::string>& paths, Provenance& provenance);

/// A scan at a meeting.
[[nodiscard]] inline Sited sited(const ScanReader& scan) { return {scan.file().name(), scan.crs_wkt()}; }

/// How each scan's coordinates become those of the first scan's frame (meeting.h).
struct ScanPlacements {
  std::vector<Placement> of;
  std::vector<std::string> said;
};

/// Throws FormatError for scans that do not meet the first one, and for two of one file_id.
[[nodiscard]] ScanPlacements place_scans(const Scans& scans, const MeetingRules& rules);

/// Throws FormatError, naming the scan, if its history names another terrain than this one.
void require_scans_of(const Scans& scans, const TerrainIdentity& terrain, const std::string& terrain_path);

struct GriddingRequest {
  GridSpec grid;
  Method method = Method::bilinear_nearest;
  bool moments = false;  ///< also what an uncertainty map needs; only with the method bilinear_nearest
  std::vector<Placement> placements = {};  ///< of the scans; empty: all are in one frame
};

/// Returns of the beginning of a scan, and how many of them lie on an edge between two bins.
struct EdgeSample {
  std::int64_t count = 0;
  std::int64_t on_edge = 0;
};

/// The returns of scans, accumulated in the bins of a DEM, and the maps that the caller computes from them.
struct GriddedScans {
  std::unique_ptr<Accumulator> bins;
  const WeightedMeanAccumulator* nearest = nullptr;  ///< the same bins, if the method is bilinear_nearest
  std::optional<MomentAccumulator> moments;
  Grid<Slope> slopes{};                           ///< slope_layer() of the bins; grid_scans() leaves it empty
  std::unique_ptr<UncertaintyMap> uncertainty{};  ///< refers to the above, which must not move any more
  std::int64_t without_place = 0;                 ///< returns beyond the horizon of the first scan's site
  std::vector<EdgeSample> edges{};  ///< of each scan: its first returns, at most 65,536; within 1e-9 bins
};

/// Grids the scans one after the other, batch by batch, while the next batch is read; the memory needed does
/// not depend on their size. Points that have no place in the first scan's frame are left out. Throws as
/// ScanReader::read() and Accumulator::add() do.
[[nodiscard]] GriddedScans grid_scans(const Scans& scans, const GriddingRequest& request,
                                      const ProgressCallback& progress = {});

}  // namespace landfall
