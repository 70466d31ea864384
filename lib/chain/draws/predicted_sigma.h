// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "chain/draws/draws_scene.h"
#include "chain/gridding/uncertainty.h"
#include "chain/hazards/return_centroids.h"
#include "chain/lidar/simulation/simulation.h"

namespace landfall {

/// 1-sigma layers of a DEM, as the file of regrid --uncertainty holds them. NaN in bins without a return or a
/// slope.
struct SigmaLayers {
  Grid<float> z_abs;
  Grid<float> z_rel;
  Grid<float> z_noise;
  ReturnCentroids centroids;
};

/// The layers of the DEM that the scan gives by the method bilinear_nearest: those of regrid --uncertainty,
/// the same bits. The simulation traces if it can, else it takes the ranges of the scene. 170 bytes per bin
/// while it runs.
[[nodiscard]] SigmaLayers predicted_sigma(const DrawsScene& scene, const Simulation& simulation,
                                          const UncertaintyParameters& parameters);

}  // namespace landfall
