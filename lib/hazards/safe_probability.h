// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "hazards/measures.h"
#include "hazards/safety.h"

namespace landfall {

/// Slope and roughness of some places of a map.
using MeasurePlaces = std::function<PlaceMeasures(const Grid<double>& z, const BinMask& places)>;

/// The probability that a place is safe, given the noise of the map. The largest of many noisy values is
/// larger than the largest true one, and by how much depends on how many of them come close; and the mean
/// over a bin hides what stands out of it. So slope and roughness m are those of the denoised map
/// (denoise.h), and their error is measured (a parametric bootstrap): noise of the bins is added to a map of
/// means over bins, which is denoised and measured again, three times. The errors d are the differences
/// to the ground of that map: the means, sharpened, and for each bin a normal draw with a third of the
/// variance that sigma has beyond noise, which is relief that the means of a few returns do not show. Over
/// the places in the square about the body, mean and standard deviation give
///   P = Phi((limit - m + mean d) / std d)
/// for roughness and for slope, taken as independent. The means of bins are the denoised map z' for std d. It
/// has lost fine relief, which mean d depends on: for mean d they are 2 z' - denoise(z'), which has it again
/// (twicing), but more noise. d is taken in every eighth row. The draws have a fixed seed: equal maps have
/// equal P.
///
/// Open are the places where `measured`, of the map as it is, is not more than 8 sigma (rms in the square
/// about the body; sigma / slope_base_m of a slope) below both limits or above one of them; P is 1 or 0
/// elsewhere. NaN where `measured` is. The form follows Ivanov, Huertas and Cohanim, AIAA 2013-5019.
[[nodiscard]] Grid<float> safe_probability(const Grid<double>& z, Grid<double> z_sigma,
                                           const LanderStencil& lander, const HazardLimits& limits,
                                           double slope_base_m, const PlaceMeasures& measured,
                                           const MeasurePlaces& measure);

}  // namespace landfall
