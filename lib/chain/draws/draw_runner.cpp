// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D320
#include "chain/draws/draw_runner.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "chain/evaluation/evaluate.h"
#include "chain/evaluation/uncertainty.h"
#include "chain/terrain/bin_elevations.h"

namespace landfall {
namespace {

Grid<double> in_double(const Grid<float>& layer) {
  auto result = Grid<double>::unset(layer.spec());
  std::ranges::copy(layer.values(), result.values().begin());
  return result;
}

/// Layers to be judged: copies of those that the maps take, too, and the others themselves.
DemLayers copied_for_maps(DrawnDem& dem) {
  TrueLayers& truth = *dem.layers.truth;
  return {.z_est = dem.layers.z_est,
          .truth = TrueLayers{std::exchange(truth.x, {}), std::exchange(truth.y, {}), truth.z}};
}

/// The metrics of dem-eval for the 1-sigma layers of a DEM: its errors are those of its file.
UncertaintyMetrics assess(SigmaLayers sigma, const DrawnDem& dem, const TerrainSurface& terrain,
                          const EvaluationParameters& parameters, const BinMask& region) {
  const GridSpec& grid = region.spec();
  Grid<double> error = bin_elevations(terrain, grid);
  for (std::size_t i = 0; i < grid.size(); ++i)  // single precision in the file
    error.values()[i] = static_cast<float>(error.values()[i]) - dem.layers.z_est.values()[i];
  return assess_uncertainty({std::move(error), std::move(sigma.z_abs), std::move(sigma.z_rel), dem.count},
                            region, footprint_of(parameters, grid.resolution_m));
}

}  // namespace

DrawsScene with_maps(DrawsScene scene) {
  scene.has_maps = true;
  if (scene.terrain != nullptr) scene.map_truth = bin_elevations(*scene.terrain, scene.grid);
  return scene;
}

DrawRunner::DrawRunner(const DrawsScene& scene, const std::optional<OpenClOptions>& device)
    : scene_(scene), gridder_(scene_.truth, scene_.grid, device) {
  const auto* const terrain = dynamic_cast<const TriangulatedGrid*>(scene_.terrain);
  if (gridder_.device() != nullptr && terrain != nullptr)
    judge_ = std::make_unique<DeviceJudge>(*gridder_.device(), *terrain, scene_.region,
                                           scene_.map_truth ? &*scene_.map_truth : nullptr);
}

void DrawRunner::check_device(DrawSetup setup) const {
  if (gridder_.device() == nullptr) return;
  gridder_.device()->check(Simulation(std::move(setup.scan), nullptr, scene_.terrain), setup.method);
}

DrawHazards DrawRunner::judge_hazards(const DemLayers& dem, const SigmaLayers* sigma,
                                      const TerrainSurface& terrain, const HazardParameters& parameters,
                                      DrawnLayers& layers) const {
  const auto complete = [&](Grid<double>& z_true, const std::vector<FillableBin>& holes) {
    for (const TruthPosition& at : truth_positions(z_true, dem.truth->x, dem.truth->y, holes))
      z_true.at(at.bin) = terrain.elevation(at.x_m, at.y_m);
    return BinMask(z_true.spec());
  };
  MapLayers map_layers{dem.z_est, dem.truth->z};
  if (sigma != nullptr) {
    map_layers.z_sigma = in_double(sigma->z_rel);
    map_layers.noise_sigma = in_double(sigma->z_noise);
    map_layers.centroids = sigma->centroids;
  }
  HazardInput input = fill_map(std::move(map_layers), parameters, complete);
  input.region = scene_.hazard_region;
  input.takes_unknown = true;  // a draw whose map is that bad counts: it has no site
  const auto run = [](const std::string& /*name*/, const auto& part) { part({}); };
  HazardMap map = map_hazards(input, parameters, run);
  layers.outcome = std::move(map.truth->outcome);
  DrawHazards hazards{map.truth->score, std::nullopt};
  if (!map.sites.empty()) hazards.best = map.sites.front();
  return hazards;
}

DrawLandings DrawRunner::land(const Simulation& simulation, const DrawSetup& setup,
                              const DrawHazards& hazards, const TerrainSurface& terrain) const {
  const LandingParameters& parameters = setup.landing->parameters;
  const auto& [velocity_x_mps, velocity_y_mps] = setup.landing->velocity_error_mps;
  const Eigen::Vector3d position_error_m = simulation.position_error(simulation.pulse_count() - 1).v;
  LandingErrors errors = draw_landing(setup.landing->seed, parameters.yaw_deg);
  errors.x_m = position_error_m.x() + parameters.drift_time_s * velocity_x_mps;
  errors.y_m = position_error_m.y() + parameters.drift_time_s * velocity_y_mps;
  const HazardParameters& hazard = *setup.hazard;
  const auto judge = [&](const Touchdown& touchdown) {
    return judge_landing(touchdown, hazard.lander, hazard.limits, scene_.grid.resolution_m,
                         [&](double x_m, double y_m) { return terrain.elevation(x_m, y_m); });
  };
  const LandingSite site = hazards.best.value_or(LandingSite{});
  const double blind_sigma_m = parameters.blind_sigma_m.value_or(hazard.touchdown_sigma_m);
  return {judge(errors.touchdown(site.x_m, site.y_m, hazard.touchdown_sigma_m)),
          judge(errors.touchdown(0, 0, blind_sigma_m))};
}

std::optional<DecisiveMetrics> DrawRunner::judge_on_device(const Simulation& simulation,
                                                           const DrawSetup& setup, MetricsKind kind) {
  if (!judge_ || kind != MetricsKind::verdict || setup.hazard) return std::nullopt;
  return judge_->judge(simulation, setup.method, setup.truth_at, setup.evaluation);
}

bool DrawRunner::take_from_device(std::int64_t draws, DrawMaps& maps) {
  return judge_ && judge_->take_maps(draws, maps);
}

DrawResult DrawRunner::run(DrawSetup setup, const DrawTerrain& terrain, MetricsKind kind,
                           DrawnLayers& layers) {
  const Simulation simulation = terrain.simulate(std::move(setup.scan));
  if (const auto metrics = judge_on_device(simulation, setup, kind))
    return {.metrics = *metrics, .hazards = std::nullopt, .is_on_device = scene_.has_maps};
  DrawnDem& dem = layers.dem;
  gridder_.draw(simulation, setup.method, setup.truth_at, terrain.surface, dem);
  std::optional<SigmaLayers> sigma;
  if (setup.uncertainty) sigma = predicted_sigma(scene_, simulation, *setup.uncertainty);
  std::optional<DrawHazards> hazards;
  std::optional<DrawLandings> landings;
  if (setup.hazard)
    hazards = judge_hazards(dem.layers, sigma ? &*sigma : nullptr, terrain.surface, *setup.hazard, layers);
  if (setup.landing) landings = land(simulation, setup, *hazards, terrain.surface);
  if (kind == MetricsKind::verdict) {
    Verdict verdict = decide(dem.layers, scene_.region, setup.evaluation);
    layers.fail = std::move(verdict.fail);
    return {verdict.metrics, std::move(hazards), landings};
  }
  std::optional<UncertaintyMetrics> assessed;
  if (sigma) assessed = assess(*std::move(sigma), dem, terrain.surface, setup.evaluation, scene_.region);
  DemLayers judged = scene_.has_maps ? copied_for_maps(dem) : std::exchange(dem.layers, {});
  if (has_mask(setup.evaluation.region_shape)) judged.region_mask = scene_.region;
  judged.count = dem.count;
  judged.truth_spacing_m = terrain.spacing_m;
  Evaluation evaluation = evaluate(std::move(judged), setup.evaluation);
  layers.fail = std::move(evaluation.fail);
  evaluation.metrics.uncertainty = std::move(assessed);
  judge_own_requirements(evaluation.metrics, setup.evaluation.own_requirements);
  return {std::move(evaluation.metrics), std::move(hazards), landings};
}

}  // namespace landfall
