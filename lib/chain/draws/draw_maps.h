// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/numerics/wide_sum.h"
#include "base/raster/grid.h"
#include "base/raster/region.h"
#include "chain/draws/draw_gridder.h"
#include "chain/evaluation/fail_flag.h"

namespace landfall {

/// Sums of one error over the draws, per bin. Errors are rounded to 2^-30 m (9.3e-10 m, ties to even) and
/// added as integers, so that a sum does not depend on how the draws are divided into parts.
struct ErrorSums {
  Grid<std::int32_t> count;  ///< draws in which the bin has an error
  Grid<std::int64_t> sum;
  Grid<WideSum> squares;

  explicit ErrorSums(const GridSpec& grid) : count(grid), sum(grid), squares(grid) {}
  /// Adds an error of one bin; NaN adds nothing. Throws FormatError beyond +-65,536 m: sums of up to
  /// 2^17 draws are exact.
  void add(std::size_t bin, double error_m);
  void merge(const ErrorSums& other);
  /// NaN without a draw, of std with fewer than two: std is divided by count - 1.
  [[nodiscard]] double mean_m(std::size_t bin) const;
  [[nodiscard]] double std_m(std::size_t bin) const;
};

/// The safety of each place over the draws, where it is known in the draw's map and on the true terrain.
struct SafetyCounts {
  Grid<std::int32_t> known;        ///< draws in which both are known
  Grid<std::int32_t> judged_safe;  ///< of these, draws in which the map says safe
  Grid<std::int32_t> missed;       ///< of these, draws in which it is a hazard in truth

  explicit SafetyCounts(const GridSpec& grid) : known(grid), judged_safe(grid), missed(grid) {}
  /// Adds the outcome of one draw: the layer `outcome` of hazards.h5.
  void add(const Grid<std::int8_t>& outcome);
  void merge(const SafetyCounts& other);
};

/// The layers of one draw that the maps take.
struct DrawnLayers {
  DrawnDem dem;
  Grid<std::int8_t> fail;  ///< FailFlag bits (evaluate.h); 0 outside the region
  std::optional<Grid<std::int8_t>> outcome = std::nullopt;  ///< of hazards.h5; of a draw that judges hazards
};

/// The flags whose footprints are counted, in the order of DrawMaps::failing.
inline constexpr std::array kCountedFlags = {fail_relative_x, fail_relative_y, fail_relative_z,
                                             fail_absolute_horizontal};

/// The sums from which the maps of a run of draws are made: counts and integer sums over its draws, per bin
/// of the DEM. 84 bytes per bin, 96 with hazards.
struct DrawMaps {
  std::int64_t draws = 0;
  Grid<std::int32_t> invalid;  ///< draws in which the bin has no elevation
  /// Draws in which the footprint centred on the bin has the flag.
  std::array<Grid<std::int32_t>, kCountedFlags.size()> failing;
  Grid<std::int64_t> count;  ///< returns
  ErrorSums e_z;             ///< z_true - z_est
  /// H(X, Y) - z_est, (X, Y) the bin's centre; none where the terrain varies.
  std::optional<ErrorSums> e_map;
  std::optional<SafetyCounts> safety;  ///< of a run of draws that judges hazards

  explicit DrawMaps(const GridSpec& grid);
  [[nodiscard]] const GridSpec& spec() const { return invalid.spec(); }

  /// Adds one draw: add_dem(), add_verdicts() and its outcome.
  void add(const DrawnLayers& draw, const Grid<double>* map_truth);
  /// Adds the DEM of one draw. `map_truth` is H(X, Y), NaN off the terrain; null only without e_map.
  void add_dem(const DrawnDem& dem, const Grid<double>* map_truth);
  /// Adds the verdicts on the footprints of the same draw: FailFlag bits (evaluate.h), 0 outside the region.
  void add_verdicts(const Grid<std::int8_t>& fail);
  /// Adds the draws of another part. Both lie on one grid.
  void merge(const DrawMaps& other);
};

}  // namespace landfall
