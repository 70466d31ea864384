// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "campaign/draw_maps.h"

namespace landfall {

/// The layers that follow from the sums of a campaign, as draws.h5 stores and its report shows them.

/// `count` is one of `maps`: the share of its draws. NaN outside `region`, unless that is null.
[[nodiscard]] Grid<float> share_of_draws(const DrawMaps& maps, const Grid<std::int32_t>& count,
                                         const BinMask* region);
/// `count` is one of `safety`: the share of the draws in which the place is known; NaN where there is none.
[[nodiscard]] Grid<float> share_of_known(const SafetyCounts& safety, const Grid<std::int32_t>& count);
/// Returns per draw.
[[nodiscard]] Grid<float> mean_count(const DrawMaps& maps);
/// Metres.
[[nodiscard]] Grid<float> mean_of(const ErrorSums& sums);
[[nodiscard]] Grid<float> std_of(const ErrorSums& sums);
/// std_of(sums) / sigma_m; NaN where sigma_m is not positive.
[[nodiscard]] Grid<float> std_over_sigma(const ErrorSums& sums, const Grid<float>& sigma_m);

}  // namespace landfall
