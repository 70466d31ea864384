// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/core/progress.h"
#include "chain/gridding/layers.h"
#include "chain/terrain/surface.h"
#include "store/files/landfall_file.h"
#include "store/files/scan_gridding.h"

namespace landfall {

/// The layers of a DEM to write, and their sources.
struct DemRequest {
  std::vector<std::string> layers;        ///< names; empty: all that can be computed
  const TerrainSurface* truth = nullptr;  ///< the terrain; without it no layer of truth is written
  TruthAt truth_at = TruthAt::bin_center;
  bool true_points = true;    ///< the scans have true points; else x_true and y_true are left out
  bool times = true;          ///< the scans have times; else their mean is left out
  bool uncertainty = false;   ///< also the truth of the map and the sigmas
  bool corrected = false;     ///< also the corrected elevation
  std::string left_out = {};  ///< what the sigmas leave out, for their attribute `comment`
  std::optional<double> truth_spacing_m = {};  ///< of z_true: TerrainIdentity::spacing_m
  double epoch_s = 0;  ///< what the clock shows at the time 0 of the returns, for the attribute of times
};

/// The layer names that a DEM may have, in the order of the file.
[[nodiscard]] const std::vector<std::string>& dem_layer_names();

/// Throws UsageError for a name that is not a layer, or for a layer that cannot be computed from the request:
/// truth without a terrain or without true points, times without times, a sigma without `uncertainty`,
/// the corrected elevation without `corrected`.
void check_layers(const DemRequest& request);

/// Writes dem.h5 (docs/user/files/dem.md), tile by tile, and commits. The scans must have the maps from which
/// the requested layers are computed: slopes for the corrected elevation, the uncertainty for the sigmas.
/// Returns the number of bins without a return.
std::int64_t write_dem(LandfallFileWriter& file, const GriddedScans& scans, const DemRequest& request,
                       const std::string& crs_wkt, const ProgressCallback& progress = {});

}  // namespace landfall
