// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D318
#include "chain/draws/predicted_sigma.h"

#include <algorithm>
#include <vector>

#include "base/core/parallel.h"
#include "chain/gridding/moment_accumulator.h"

namespace landfall {
namespace {

constexpr std::int64_t kPointsPerBatch = std::int64_t{1} << 20U;

/// The returns from which the map is made.
struct GriddedReturns {
  WeightedMeanAccumulator bins;
  MomentAccumulator moments;
  PulseColumns pulses;

  explicit GriddedReturns(const GridSpec& grid) : bins(grid), moments(grid) {}

  /// Replaces the times of the batch by those since the first pulse, as regrid does.
  void add(PulseBatch& batch, std::int64_t first_pulse, const Simulation& simulation) {
    for (std::size_t k = 0; k < batch.pulses.t.size(); ++k)
      batch.pulses.t[k] = simulation.since_start_s(first_pulse + static_cast<std::int64_t>(k));
    std::vector<double> times(batch.points.size());
    std::ranges::transform(batch.points.pulse, times.begin(), [&](std::int32_t pulse) {
      return batch.pulses.t[static_cast<std::size_t>(pulse - first_pulse)];
    });
    const GridPoints points = GridPoints::of(batch.points, times);
    bins.add(points);
    moments.add(points, bins);
    for (const auto member :
         {&PulseColumns::t, &PulseColumns::px_est, &PulseColumns::py_est, &PulseColumns::pz_est,
          &PulseColumns::qw_est, &PulseColumns::qx_est, &PulseColumns::qy_est, &PulseColumns::qz_est})
      (pulses.*member)
          .insert((pulses.*member).end(), (batch.pulses.*member).begin(), (batch.pulses.*member).end());
  }
};

GriddedReturns gridded_returns(const DrawsScene& scene, const Simulation& simulation) {
  GriddedReturns gridded(scene.grid);
  const auto pixels = static_cast<std::int64_t>(simulation.pixel_count());
  const std::int64_t per_batch = std::max<std::int64_t>(1, kPointsPerBatch / pixels);
  PulseBatch batch;
  for (std::int64_t first = 0; first < simulation.pulse_count(); first += per_batch) {
    const PulseSpan span{first, std::min(per_batch, simulation.pulse_count() - first)};
    if (simulation.can_trace())
      simulation.simulate(span, batch);
    else
      simulation.replay(span,
                        scene.truth.part(static_cast<std::size_t>(first * pixels),
                                         static_cast<std::size_t>(span.count * pixels)),
                        batch);
    batch.keep_returns();
    gridded.add(batch, first, simulation);
  }
  return gridded;
}

}  // namespace

SigmaLayers predicted_sigma(const DrawsScene& scene, const Simulation& simulation,
                            const UncertaintyParameters& parameters) {
  const GriddedReturns gridded = gridded_returns(scene, simulation);
  const Grid<Slope> slopes = slope_layer(gridded.bins);
  const PoseTrack poses({estimated_poses("the scan", gridded.pulses)});
  const UncertaintyMap map(gridded.bins, gridded.moments, slopes, poses, parameters);
  const auto unset = [&] { return Grid<float>::unset(scene.grid); };
  SigmaLayers layers{unset(), unset(), unset(), {unset(), unset()}};
  parallel_for(static_cast<std::size_t>(scene.grid.rows), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<BinValues> row(static_cast<std::size_t>(scene.grid.cols));
    for (auto r = static_cast<std::int64_t>(begin); r < static_cast<std::int64_t>(end); ++r) {
      gridded.bins.values({r, 0}, row);
      for (std::int64_t c = 0; c < scene.grid.cols; ++c) {
        const BinValues& values = row[static_cast<std::size_t>(c)];
        const bool is_filled = values.count > 0;
        const BinSigmas sigmas = is_filled ? map.sigmas({r, c}) : BinSigmas{};
        layers.z_abs.at({r, c}) = static_cast<float>(sigmas.z_abs);
        layers.z_rel.at({r, c}) = static_cast<float>(sigmas.z_rel);
        layers.z_noise.at({r, c}) = static_cast<float>(sigmas.z_noise);
        layers.centroids.x.at({r, c}) = static_cast<float>(values.x_est);
        layers.centroids.y.at({r, c}) = static_cast<float>(values.y_est);
      }
    }
  });
  return layers;
}

}  // namespace landfall
