// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/raster/grid_spec.h"
#include "base/raster/region.h"
#include "chain/lidar/simulation/pulse_simulator.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// The inputs that the draws of a run share; none changes them.
struct DrawsScene {
  TrueRanges truth;  ///< one range per pixel and pulse, and its echo if the receiver uses waveforms; empty
                     ///< for draws that trace
  const TerrainSurface* terrain;  ///< the true terrain of all draws; null where it varies
  GridSpec grid;
  BinMask region;                                       ///< judged_region(), which no draw changes
  std::optional<BinMask> hazard_region = std::nullopt;  ///< HazardInput::region
  bool has_maps = false;                                ///< the draws are added to DrawMaps
  /// H at the bins' centres, NaN off the terrain; only with maps of one terrain.
  std::optional<Grid<double>> map_truth = std::nullopt;
};

/// The scene of a run with maps.
[[nodiscard]] DrawsScene with_maps(DrawsScene scene);

}  // namespace landfall
