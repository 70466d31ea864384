// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "hazards/measures.h"
#include "hazards/safety.h"

namespace landfall {

/// A map, in metres, and the variance of each bin, in square metres.
struct DenoisedMap {
  Grid<double> z;
  Grid<double> variance;
};

/// Weighs each bin against the quadratic surface through the 24 bins around it, which does not use the bin
/// itself. The variance of the surface is that of the noise in it plus the terrain's departure from it: the
/// mean over 3 x 3 bins of the squared misfit beyond what noise explains. So noise is averaged where the
/// ground is smooth, and an edge stays as it was measured. A bin stays, too, where one of the bins involved
/// is not finite or off the map. `z_sigma` is the 1 sigma of each bin, independent of the others.
[[nodiscard]] DenoisedMap denoise(const Grid<double>& z, const Grid<double>& z_sigma);

/// Slope and roughness of some places of a map.
using MeasurePlaces = std::function<PlaceMeasures(const Grid<double>& z, const BinMask& places)>;

/// The probability that a place is safe, given the noise of the map. The largest of many noisy values is
/// larger than the largest true one, and by how much depends on how many of them come close. So slope and
/// roughness m are those of the denoised map, and their error is measured (a parametric bootstrap): noise of
/// the bins' sigma is added to the denoised map, which is denoised and measured again, kReplicates times. Of
/// the change d of the open places within a body's radius, mean and standard deviation give
///   P = Phi((limit - m + mean d) / std d)
/// for roughness and for slope, taken as independent. The noise has a fixed seed: equal maps have equal P.
///
/// Open are the places where `measured`, of the map as it is, is not more than 8 sigma (rms in the square
/// about the body; sigma / slope_base_m of a slope) below both limits or above one of them; P is 1 or 0
/// elsewhere. NaN where `measured` is. The form follows Ivanov, Huertas and Cohanim, AIAA 2013-5019.
[[nodiscard]] Grid<float> safe_probability(const Grid<double>& z, const Grid<double>& z_sigma,
                                           const LanderStencil& lander, const HazardLimits& limits,
                                           double slope_base_m, const PlaceMeasures& measured,
                                           const MeasurePlaces& measure);

}  // namespace landfall
