// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "campaign/draw_runner.h"
#include "gridding/uncertainty.h"

namespace landfall {

/// z_sigma_abs of the DEM that the scan gives by the method bilinear_nearest: the layer of regrid
/// --uncertainty, the same bits. NaN in bins without a return or a slope. 170 bytes per bin while it runs.
[[nodiscard]] Grid<float> predicted_sigma(const CampaignScene& scene, ScanModel scan,
                                          const UncertaintyParameters& parameters);

}  // namespace landfall
