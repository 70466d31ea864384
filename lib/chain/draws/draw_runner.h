// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D379
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <variant>

#include "base/numerics/random_seed.h"
#include "chain/draws/device_judge.h"
#include "chain/draws/draw_gridder.h"
#include "chain/draws/draw_maps.h"
#include "chain/draws/draws_scene.h"
#include "chain/draws/predicted_sigma.h"
#include "chain/evaluation/judge/verdict.h"
#include "chain/evaluation/metrics.h"
#include "chain/evaluation/parameters.h"
#include "chain/hazards/hazard_map.h"
#include "chain/hazards/landing.h"

namespace landfall {

/// The metrics of a draw that are computed.
enum class MetricsKind {
  full,     ///< all of metrics.json
  verdict,  ///< the numbers that decide the six requirements: no percentiles, several times faster
};

/// By MetricsKind.
using DrawMetrics = std::variant<Metrics, DecisiveMetrics>;

/// The score of a draw's hazard map on the true terrain.
struct DrawHazards {
  HazardScore score;
  std::optional<LandingSite> best;  ///< the chosen place; none where no place is safe
};

/// How a run's draws land.
struct LandingParameters {
  double drift_time_s = 0;              ///< for which the velocity error acts after the last pulse
  std::optional<double> yaw_deg;        ///< none: drawn, uniform in [0, 360)
  std::optional<double> blind_sigma_m;  ///< dispersion without a lidar; none: that with it
};

/// The landing of a draw.
struct LandingSetup {
  LandingParameters parameters;
  RandomSeed seed = {};
  std::array<double, 2> velocity_error_mps{};  ///< x, y
};

/// The landing at the draw's best site, at the origin where it has none, and the same draw without a lidar,
/// which lands at the origin.
struct DrawLandings {
  Landing lidar;
  Landing blind;
};

struct DrawResult {
  DrawMetrics metrics;
  std::optional<DrawHazards> hazards;
  std::optional<DrawLandings> landings = std::nullopt;
  bool is_on_device = false;  ///< the maps do not have it yet: DrawRunner::take_from_device()
};

/// The configuration of one draw.
struct DrawSetup {
  ScanModel scan;  ///< with the draw's seed
  Method method = Method::bilinear_nearest;
  TruthAt truth_at = TruthAt::bin_center;
  EvaluationParameters evaluation;
  std::optional<HazardParameters> hazard = std::nullopt;
  std::optional<LandingSetup> landing = std::nullopt;  ///< only with hazard
  /// Makes the 1-sigma layers of the DEM; only with the method bilinear_nearest.
  std::optional<UncertaintyParameters> uncertainty = std::nullopt;
};

/// Runs draws one after the other: traces or replays, grids and judges in memory. Several objects may run
/// draws of one scene at the same time. Memory does not depend on the number of draws. A device judges them
/// too (DeviceJudge) where the metrics are MetricsKind::verdict, no hazards are requested and the terrain is
/// a grid in memory.
class DrawRunner {
 public:
  /// `scene` must outlive this object. With `device`, an OpenCL device draws and bins (DeviceGridder).
  explicit DrawRunner(const DrawsScene& scene, const std::optional<OpenClOptions>& device = std::nullopt);

  /// Throws UsageError, naming the key, for a draw that the device must make and cannot.
  void check_device(DrawSetup setup) const;

  /// The metrics of the draw on this ground: those of scan-sim (without an engine, of scan-sim
  /// --ranges-from), regrid and dem-eval --metrics-only, bit for bit; score and best site those of hazard-map
  /// --terrain. Sets `layers`, whose memory is used again, in a run with maps, unless the draw is on the
  /// device. Throws as Simulation, DrawGridder, evaluate() and map_hazards() do.
  [[nodiscard]] DrawResult run(DrawSetup setup, const DrawTerrain& terrain, MetricsKind kind,
                               DrawnLayers& layers);

  /// Adds the draws on the device, whose number is given, to `maps`. Returns false if the device has lost
  /// them and the CPU takes over: they must be run again.
  [[nodiscard]] bool take_from_device(std::int64_t draws, DrawMaps& maps);

 private:
  [[nodiscard]] std::optional<DecisiveMetrics> judge_on_device(const Simulation& simulation,
                                                               const DrawSetup& setup, MetricsKind kind);
  [[nodiscard]] DrawHazards judge_hazards(const DemLayers& dem, const SigmaLayers* sigma,
                                          const TerrainSurface& terrain, const HazardParameters& parameters,
                                          DrawnLayers& layers) const;

  [[nodiscard]] DrawLandings land(const Simulation& simulation, const DrawSetup& setup,
                                  const DrawHazards& hazards, const TerrainSurface& terrain) const;

  const DrawsScene& scene_;
  DrawGridder gridder_;
  std::unique_ptr<DeviceJudge> judge_;  ///< null without a device, or if it cannot judge
};

}  // namespace landfall
