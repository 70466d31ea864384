// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D320
#include "campaign/draw_runner.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "evaluation/evaluate.h"

namespace landfall {
namespace {

Grid<double> elevations_of(const TerrainSurface& terrain, const GridSpec& grid) {
  auto map = Grid<double>::unset(grid);
  parallel_for(static_cast<std::size_t>(grid.rows), 16, [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
      for (std::int64_t col = 0; col < grid.cols; ++col)
        map.at({row, col}) = terrain.elevation(grid.x(col), grid.y(row));
  });
  return map;
}

}  // namespace

DrawRunner::DrawRunner(CampaignScene scene, bool with_maps, const std::optional<OpenClOptions>& device)
    : scene_(std::move(scene)), gridder_(scene_.truth, scene_.terrain, scene_.grid, device) {
  if (with_maps) z_true_map_ = elevations_of(scene_.terrain, scene_.grid);
  const auto* const ground = dynamic_cast<const TriangulatedGrid*>(&scene_.terrain);
  if (gridder_.device() != nullptr && ground != nullptr)
    judge_ = std::make_unique<DeviceJudge>(*gridder_.device(), *ground, scene_.region,
                                           z_true_map_ ? &*z_true_map_ : nullptr);
}

void DrawRunner::check_device(DrawSetup setup) const {
  if (gridder_.device() == nullptr) return;
  gridder_.device()->check(Simulation(std::move(setup.scan), nullptr, &scene_.terrain), setup.method);
}

DrawHazards DrawRunner::judge_hazards(const DemLayers& dem, const HazardParameters& parameters,
                                      DrawMaps* maps) const {
  const auto complete = [&](Grid<double>& z_true, const std::vector<FillableBin>& holes) {
    for (const TruthPosition& at : truth_positions(z_true, dem.truth->x, dem.truth->y, holes))
      z_true.at(at.bin) = scene_.terrain.elevation(at.x_m, at.y_m);
    return BinMask(z_true.spec());
  };
  HazardInput input = fill_map({dem.z_est, dem.truth->z}, parameters, complete);
  const auto run = [](const std::string& /*name*/, const auto& part) { part({}); };
  const HazardMap map = map_hazards(input, parameters, run);
  if (maps != nullptr) maps->safety->add(map.truth->outcome);
  DrawHazards hazards{map.truth->score, std::nullopt};
  if (!map.sites.empty()) hazards.best = map.sites.front();
  return hazards;
}

std::optional<DecisiveMetrics> DrawRunner::judge_on_device(const Simulation& simulation,
                                                           const DrawSetup& setup, MetricsKind kind) {
  if (!judge_ || kind != MetricsKind::verdict || setup.hazard) return std::nullopt;
  return judge_->judge(simulation, setup.method, setup.truth_at, setup.evaluation);
}

bool DrawRunner::take_from_device(std::int64_t draws, DrawMaps& maps) {
  return judge_ && judge_->take_maps(draws, maps);
}

DrawResult DrawRunner::run(DrawSetup setup, MetricsKind kind, DrawMaps* maps) {
  const Simulation simulation(std::move(setup.scan), nullptr, &scene_.terrain);
  if (const auto metrics = judge_on_device(simulation, setup, kind))
    return {*metrics, std::nullopt, maps != nullptr};
  DrawnDem& dem = gridder_.draw(simulation, setup.method, setup.truth_at);
  if (maps != nullptr) maps->add_dem(dem, *z_true_map_);
  std::optional<DrawHazards> hazards;
  if (setup.hazard) hazards = judge_hazards(dem.layers, *setup.hazard, maps);
  if (kind == MetricsKind::verdict) {
    const Verdict verdict = decide(dem.layers, scene_.region, setup.evaluation);
    if (maps != nullptr) maps->add_verdicts(verdict.fail);
    return {verdict.metrics, std::move(hazards)};
  }
  if (setup.evaluation.region_shape == RegionShape::mask) dem.layers.region_mask = scene_.region;
  const Evaluation evaluation = evaluate(std::exchange(dem.layers, {}), setup.evaluation);
  if (maps != nullptr) maps->add_verdicts(evaluation.fail);
  return {evaluation.metrics, std::move(hazards)};
}

}  // namespace landfall
