// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "evaluation/dem_layers.h"
#include "evaluation/metrics.h"
#include "raster/footprint.h"

namespace landfall {

/// The assumptions of a verdict on a DEM (D451). The returns are those of the layer `count` of the region's
/// bins; none without the layer or without a return.
[[nodiscard]] AssumptionMetrics assumptions_of(const DemLayers& dem, const BinMask& region,
                                               const Footprint& footprint);

}  // namespace landfall
