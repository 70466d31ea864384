// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "gridding/bin_accumulator.h"
#include "gridding/layers.h"
#include "io/landfall_file.h"
#include "terrain/triangulated_grid.h"

namespace landfall {

/// Which layers of a DEM to write, and from what.
struct DemRequest {
  std::vector<std::string> layers;          ///< names; empty: all
  const TriangulatedGrid* truth = nullptr;  ///< the terrain; without it z_true is left out
  TruthAt truth_at = TruthAt::bin_center;
};

/// The names that a DEM may have, in the order of the file.
[[nodiscard]] const std::vector<std::string>& dem_layer_names();

/// Throws UsageError for a name that is no layer, or for z_true without a terrain.
void check_layers(const DemRequest& request);

/// Writes dem.h5 (SPEC sections 5 and 8), one layer in memory at a time, and commits.
void write_dem(LandfallFileWriter& file, const BinAccumulator& bins, const DemRequest& request,
               const std::string& crs_wkt, const ProgressCallback& progress = {});

}  // namespace landfall
