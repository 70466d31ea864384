// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "base/raster/grid.h"
#include "base/raster/region.h"

namespace landfall {

/// The true position of the terrain under each bin: metres, NaN where unknown.
struct TrueLayers {
  Grid<double> x;  ///< without bins, as y, where only elevations are known: nothing horizontal is judged
  Grid<double> y;
  Grid<double> z;

  [[nodiscard]] bool has_positions() const { return x.spec().size() > 0; }
};

/// The input of an evaluation: the estimated elevation, NaN where a bin is empty, and the truth. A DEM that
/// lacks the true elevations has no truth.
struct DemLayers {
  Grid<double> z_est;
  std::optional<TrueLayers> truth;
  /// Another estimate of the elevation, corrected by the local slope: measured like z_est, never judged.
  std::optional<Grid<double>> corrected = std::nullopt;
  /// Which bins are judged, for RegionShape::mask and polygon.
  std::optional<BinMask> region_mask = std::nullopt;
  std::optional<Grid<std::int32_t>> count = std::nullopt;  ///< returns of each bin
  /// Between the nodes of the terrain that is the truth; none if unknown, or if it is exact at any spacing.
  std::optional<double> truth_spacing_m = std::nullopt;
};

/// Throws FormatError, naming the layer, when layers differ in grid or hold an infinite value.
void check_layers(const DemLayers& dem);

}  // namespace landfall
