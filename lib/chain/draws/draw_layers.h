// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "chain/draws/draw_maps.h"

namespace landfall {

/// The layers that follow from the sums of a run of draws, as draws.h5 stores and its report shows them.

/// One kind of failing footprints: its layer, the error above its limit and the requirement that they miss.
struct FailureMap {
  const char* layer;
  const char* error;
  const char* requirement;
  const Grid<std::int32_t>& count;  ///< draws
};
/// By kCountedFlags.
[[nodiscard]] std::array<FailureMap, 4> failure_maps(const DrawMaps& maps);

/// `count` / `draws`. NaN outside `region`, unless that is null, and everywhere without a draw.
[[nodiscard]] Grid<float> share_of_draws(const Grid<std::int32_t>& count, std::int64_t draws,
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
