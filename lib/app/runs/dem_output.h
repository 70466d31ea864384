// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "store/config/dem_config.h"
#include "store/files/dem_file.h"
#include "store/files/meeting.h"

namespace landfall {

/// The scans, and the terrain if any, of a DEM.
struct DemSources {
  std::vector<std::string> scans;  ///< scan.h5, at least one
  std::string terrain;             ///< terrain.h5 for the layers of the truth; empty: none
  MeetingRules rules = {};         ///< same_frame also accepts a terrain other than the one that was scanned
};

/// A DEM's output and the data that it needs besides the scans.
struct DemOutput {
  OutputOptions file;
  Provenance provenance;    ///< without its inputs, which are added later
  std::string config_name;  ///< for messages
  PhaseRunner phase;
};

struct BinnedReturns {
  std::int64_t inside_count = 0;
  std::int64_t outside_count = 0;  ///< off the grid
  std::int64_t empty_bins = 0;
  std::vector<std::string> warnings = {};  ///< about frames, sigmas and edges of bins
  /// Which returns of a pixel the scans hold, and the DEM uses: their values of /receiver/returns, "one" for
  /// scans without a receiver; "first, all" if they differ.
  std::string returns_used = {};
};

/// Grids scans into dem.h5. `layers.truth`, its spacing and `layers.truth_at` are set here. The
/// provenance's configuration gives the sigmas of the uncertainty; missing ones are taken from the scans, and
/// all are recorded. Throws UsageError as check_layers() and uncertainty_parameters() do, FormatError for a
/// scan of another terrain, and as the readers and PoseTrack do.
BinnedReturns make_dem(const RegridConfig& config, const DemSources& sources, DemRequest layers,
                       DemOutput output);

}  // namespace landfall
