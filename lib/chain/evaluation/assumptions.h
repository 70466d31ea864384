// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/raster/footprint.h"
#include "chain/evaluation/dem_layers.h"
#include "chain/evaluation/metrics.h"

namespace landfall {

/// The assumptions of a verdict on a DEM (D451). The returns are those of the layer `count` of the region's
/// bins; none without the layer or without a return.
[[nodiscard]] AssumptionMetrics assumptions_of(const DemLayers& dem, const BinMask& region,
                                               const Footprint& footprint);

}  // namespace landfall
