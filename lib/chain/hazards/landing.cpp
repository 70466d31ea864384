// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/landing.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "base/numerics/random.h"
#include "chain/hazards/pose.h"

namespace landfall {
namespace {

/// The elevations under a lander that stands at `place`.
Grid<double> terrain_under(const LanderStencil& lander, BinIndex place, const TerrainElevation& elevation) {
  std::int64_t half = lander.body.half_bins();
  for (const BinOffset& pad : lander.yaws.front())
    half = std::max(half, std::max(std::abs(pad.rows), std::abs(pad.cols)) + lander.pad.half_bins());
  auto z = Grid<double>::unset(
      GridSpec{lander.resolution_m, place.row - half, place.col - half, 2 * half + 1, 2 * half + 1});
  for (std::int64_t row = 0; row < z.spec().rows; ++row)
    for (std::int64_t col = 0; col < z.spec().cols; ++col)
      z.at({row, col}) = elevation(z.spec().x(col), z.spec().y(row));
  return z;
}

}  // namespace

Landing judge_landing(const Touchdown& touchdown, const Lander& lander, const HazardLimits& limits,
                      double resolution_m, const TerrainElevation& elevation) {
  const LanderStencil stencil(lander, resolution_m, touchdown.yaw_deg * (std::numbers::pi / 180));
  const BinIndex place = GridSpec{resolution_m}.bin_of(touchdown.x_m, touchdown.y_m);
  const Grid<double> z = terrain_under(stencil, place, elevation);
  const BinIndex centre = {(z.spec().rows - 1) / 2, (z.spec().cols - 1) / 2};
  const auto poses = worst_contact_poses(z, stencil, centre);
  constexpr double kNoTerrain = std::numeric_limits<double>::quiet_NaN();
  if (!poses) return {touchdown, kNoTerrain, kNoTerrain, false};
  const double slope_deg = poses->steepest.slope_deg;
  const double roughness_m = poses->roughest.roughness_m;
  return {touchdown, slope_deg, roughness_m,
          slope_deg <= limits.slope_deg && roughness_m <= limits.roughness_m};
}

LandingErrors draw_landing(RandomSeed seed, const std::optional<double>& yaw_deg) {
  const RandomField touchdown(seed, RandomStream::touchdown);
  const RandomField yaw(seed, RandomStream::landing_yaw);
  return {.unit_x = touchdown.normal(0),
          .unit_y = touchdown.normal(1),
          .yaw_deg = yaw_deg.value_or(360 * yaw.uniform(0))};
}

}  // namespace landfall
