// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D286
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/raster/by_rows.h"
#include "base/raster/window_extremes.h"
#include "chain/hazards/measure_rows.h"
#include "chain/hazards/measures.h"
#include "chain/hazards/reach.h"

namespace landfall {
namespace {

/// The median, by a sorting network (A. W. Paeth, Graphics Gems, 1990) of which only the middle is computed.
double median_of(std::array<double, 9>& v) {
  constexpr std::array<std::array<std::uint8_t, 2>, 19> kExchanges = {{{1, 2},
                                                                       {4, 5},
                                                                       {7, 8},
                                                                       {0, 1},
                                                                       {3, 4},
                                                                       {6, 7},
                                                                       {1, 2},
                                                                       {4, 5},
                                                                       {7, 8},
                                                                       {0, 3},
                                                                       {5, 8},
                                                                       {4, 7},
                                                                       {3, 6},
                                                                       {1, 4},
                                                                       {2, 5},
                                                                       {4, 7},
                                                                       {4, 2},
                                                                       {6, 4},
                                                                       {4, 2}}};
  for (const auto& [a, b] : kExchanges) {
    const double minimum = std::min(v[a], v[b]);
    v[b] = std::max(v[a], v[b]);
    v[a] = minimum;
  }
  return v[4];
}

/// The median of each bin and its eight neighbours; without meaning where one of them is missing.
Grid<double> medians(const PaddedMap& z, const GridSpec& spec) {
  auto result = Grid<double>::unset(spec);
  by_rows(spec, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      std::array<double, 9> near;
      for (std::int64_t r = 0; r < 3; ++r)
        std::copy_n(z.at(row + r - 1, col - 1), 3, &near[3 * static_cast<std::size_t>(r)]);
      result.row(row)[static_cast<std::size_t>(col)] = median_of(near);
    }
  });
  return result;
}

/// Largest less smallest value in the square window about each bin.
Grid<double> ranges(const Grid<double>& values, std::int64_t half_bins) {
  Grid<double> result = window_max(values, half_bins);
  const Grid<double> minimum = window_min(values, half_bins);
  for (std::size_t i = 0; i < result.spec().size(); ++i) result.values()[i] -= minimum.values()[i];
  return result;
}

}  // namespace

std::int64_t rock_half_bins(double height_m, double resolution_m) {
  constexpr double kTolerance_m = 1e-9;
  return static_cast<std::int64_t>(std::floor((height_m + kTolerance_m) / resolution_m));
}

PlaceMeasures measure_range_difference(const Grid<double>& z, const RangeWindows& windows,
                                       const BinMask& places, const ProgressCallback& progress) {
  const Reach reach = Reach::of_square(windows.lander_half_bins + windows.rock_half_bins + 1);
  const PaddedMap padded(z, reach.bins());
  const BinMask known = reach.known(padded, places);
  const Grid<double> smooth = medians(padded, z.spec());
  const Grid<double> site = ranges(smooth, windows.lander_half_bins);
  const Grid<double> rock = window_max(ranges(smooth, windows.rock_half_bins), windows.lander_half_bins);
  const double width_m = 2 * static_cast<double>(windows.lander_half_bins) * z.spec().resolution_m;
  return measure_rows(
      z.spec(),
      [&](std::int64_t begin, std::int64_t end, PlaceMeasures& result) {
        for (std::int64_t row = begin; row < end; ++row)
          for (std::int64_t col = 0; col < z.spec().cols; ++col) {
            const BinIndex place{row, col};
            if (known.at(place) == 0) continue;
            result.slope_deg.at(place) = slope_deg(site.at(place) / width_m);
            result.roughness_m.at(place) = rock.at(place);
          }
      },
      progress);
}

}  // namespace landfall
