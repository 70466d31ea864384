// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D321
#include "app/runs/draw_series.h"

#include <algorithm>
#include <utility>

#include "app/runs/redraw.h"
#include "app/runs/region_input.h"
#include "base/core/error.h"
#include "base/memory/available_memory.h"
#include "base/raster/grid_spec.h"
#include "chain/draws/predicted_sigma.h"
#include "chain/evaluation/evaluate.h"
#include "store/config/config_path.h"
#include "store/config/hazard_config.h"
#include "store/config/path_names.h"
#include "store/config/receiver_config.h"
#include "store/config/scan_config.h"
#include "store/config/uncertainty_config.h"
#include "store/files/table_reader.h"

namespace landfall {
namespace {

/// The provenance that scan-sim --ranges-from would have.
Provenance scan_provenance(const nlohmann::json& scan, const Scene& scene) {
  Provenance provenance{.tool = "scan-sim", .config = scan};
  static_cast<void>(scan_model(scan, "scan", recording_table_loader(provenance)));
  provenance.add_input("terrain", scene.file_id, scene.chain);
  return provenance;
}

/// Calls check(draw) for the draws that decide whether all are valid; if one is refused, for all, so that the
/// message names the first one.
void check_draws(const DrawsConfig& config, const DrawSpan& span, const auto& check) {
  try {
    for (const std::int64_t draw : config.deciding_draws(span.first, span.end)) check(draw);
  } catch (const UsageError&) {
    for (std::int64_t draw = span.first; draw < span.end; ++draw) check(draw);
    throw;
  }
}

/// Refuses draws whose configuration is not valid or whose rays differ from the scan's, before any is run.
void require_same_rays(const RangeFile& scan, const Scene& scene, const DrawsConfig& config,
                       const DrawSpan& span) {
  Provenance provenance = scan_provenance(config.stages().scan, scene);
  check_draws(config, span, [&](std::int64_t draw) {
    provenance.config = config.stages(draw).scan;
    cut_paths(provenance.config);  // as those of the scan
    require_redraw(scan, provenance, "");
  });
}

/// A landing is judged by its contact with the ground, whatever the method of the map is.
void require_hazards(const DrawsConfig& config, const DrawSpan& span) {
  if (!config.has_hazards()) return;
  check_draws(config, span, [&](std::int64_t draw) {
    const DrawStages stages = config.stages(draw);
    const std::string name = config.name() + ": draw " + std::to_string(draw);
    const std::string path = name + ": /hazard";
    const Lander lander = hazard_config(stages.hazard, path).lander;
    check_hazard_map(stages.hazard, stages.regrid, name);
    if (config.landing())
      at_path(path + "/",
              [&] { return LanderStencil(lander, stages.regrid.at("resolution_m").get<double>()); });
  });
}

/// The sigmas of regrid --uncertainty in a draw; none unless they are requested.
std::optional<UncertaintyParameters> uncertainty_of(const DrawsConfig& config, const DrawStages& stages,
                                                    const std::string& name) {
  if (!config.has_uncertainty()) return std::nullopt;
  return uncertainty_parameters(stages.regrid, name + ": /regrid", {{"the scan", stages.scan}});
}

/// Refuses draws that trace whose configuration is not valid, before any is run.
void require_valid(const DrawsConfig& config, const DrawSpan& span) {
  check_draws(config, span, [&](std::int64_t draw) {
    const DrawStages stages = config.stages(draw);
    const std::string name = config.name() + ": draw " + std::to_string(draw) + ": /";
    static_cast<void>(scan_model(stages.scan, name + "scan", {}));
    static_cast<void>(regrid_config(stages.regrid, name + "regrid"));
    static_cast<void>(evaluation_config(stages.eval, name + "eval"));
    static_cast<void>(uncertainty_of(config, stages, config.name() + ": draw " + std::to_string(draw)));
    if (!stages.terrain.is_null()) static_cast<void>(terrain_config(stages.terrain, name + "terrain"));
  });
}

DrawsTruth read_truth(const RangeFile& scan, const ProgressCallback& progress) {
  constexpr std::int64_t kPulsesPerPiece = 4096;
  RangeFile file(scan.file().name());
  const nlohmann::json& detector = scan.file().config().at("detector");
  const auto pixels = detector.at("rows").get<std::size_t>() * detector.at("columns").get<std::size_t>();
  const auto pulses = static_cast<std::int64_t>(scan.pulse_count());
  DrawsTruth truth;
  truth.ranges_m.resize(scan.pulse_count() * pixels);
  if (file.keeps_echoes()) truth.echoes.resize(truth.ranges_m.size());
  for (std::int64_t first = 0; first < pulses; first += kPulsesPerPiece) {
    const RecordedRanges piece = file.read({first, std::min(kPulsesPerPiece, pulses - first)}, pixels);
    const auto row = first * static_cast<std::int64_t>(pixels);
    std::ranges::copy(piece.ranges_m, truth.ranges_m.begin() + row);
    std::ranges::copy(piece.echoes, truth.echoes.begin() + row);
    truth.later.insert(truth.later.end(), piece.later.begin(), piece.later.end());
    report(progress, static_cast<double>(first) / static_cast<double>(pulses));
  }
  return truth;
}

/// Draws that trace may meet ground and poses that others do not: says which one failed.
template <class Work>
DrawResult naming_draw(const DrawsConfig& config, std::int64_t draw, const Work& work) {
  if (!config.traces()) return work();
  try {
    return work();
  } catch (const FormatError& error) {
    throw FormatError(config.name() + ": draw " + std::to_string(draw) + ": " + error.what());
  }
}

void add_to(std::vector<DrawColumn>& columns, const std::vector<NamedNumber>& row) {
  if (columns.empty())
    for (const auto& [name, value] : row) columns.push_back({name, {}});
  for (std::size_t i = 0; i < row.size(); ++i) columns.at(i).values.push_back(row[i].second);
}

}  // namespace

DrawSeries::DrawSeries(const RangeFile& scan, TerrainSource terrain, const DrawsConfig& config,
                       const DrawSpan& span, std::optional<std::int64_t> pair,
                       const std::optional<OpenClOptions>& device, Provenance& provenance,
                       const ProgressCallback& progress)
    : config_(config),
      pair_(pair),
      source_(std::move(terrain)),
      regrid_(regrid_config(config.stages().regrid, config.name() + ": /regrid")) {
  provenance.add_input("scan", scan.file().file_id(), scan.file().chain());
  scene_ = open_scene({.terrain = source_.terrain, .use = SceneUse::surface});
  provenance.add_input("terrain", scene_.file_id, scene_.chain);
  const GridSpec& grid = regrid_.grid;
  if (scene_.window)
    scene_.window->require({grid.x(0), grid.x(grid.cols - 1), grid.y(0), grid.y(grid.rows - 1)});
  require_same_rays(scan, scene_, config, span);
  truth_ = read_truth(scan, progress);
  require_hazards(config, span);
  prepare(scene_.surface.get(), device, provenance);
  if (device && device->on_failure == DeviceFailure::throws) require_device(span);
}

DrawSeries::DrawSeries(TerrainSource terrain, const DrawsConfig& config, const DrawSpan& span,
                       Provenance& provenance)
    : config_(config),
      source_(std::move(terrain)),
      regrid_(regrid_config(config.stages().regrid, config.name() + ": /regrid")) {
  require_valid(config, span);
  require_hazards(config, span);
  const nlohmann::json& scan = config.stages().scan;
  static_cast<void>(scan_model(scan, config.name() + ": /scan", recording_table_loader(provenance)));
  if (!source_.terrain.empty()) {
    open_terrain(uses_albedo_map(scan), provenance);
  } else {
    build_terrain(config.stages(span.first).terrain, provenance);
    terrain_draw_ = span.first;
    source_.warn = [](const std::string&) {};  // of later terrains, which are alike
  }
  prepare(config.terrain_varies() ? nullptr : scene_.surface.get(), std::nullopt, provenance);
}

void DrawSeries::open_terrain(bool uses_albedo, Provenance& provenance) {
  scene_ = open_scene({.terrain = source_.terrain});
  provenance.add_input("terrain", scene_.file_id, scene_.chain);
  const GridSpec& grid = regrid_.grid;
  if (scene_.window)
    scene_.window->require({grid.x(0), grid.x(grid.cols - 1), grid.y(0), grid.y(grid.rows - 1)});
  if (uses_albedo) albedo_ = open_albedo(source_.terrain);
}

void DrawSeries::build_terrain(const nlohmann::json& terrain, Provenance& provenance) {
  scene_ = {};  // the old ground first, so that both never exist at once
  albedo_.reset();
  const TerrainInput made =
      source_.make(terrain_config(terrain, config_.name() + ": /terrain"), provenance, source_.warn);
  scene_ = traced_scene(made);
  if (made.grid) scene_.spacing_m = node_spacing_m(terrain, made.grid->nodes().spec().resolution_m);
  albedo_ = made.albedo;
}

DrawTerrain DrawSeries::terrain_of(const DrawStages& stages, std::int64_t draw) {
  if (config_.terrain_varies() && draw != terrain_draw_) {
    Provenance recorded;  // with the first ground
    build_terrain(stages.terrain, recorded);
    terrain_draw_ = draw;
  }
  return {*scene_.surface, scene_.engine.get(), albedo_.get(), scene_.spacing_m};
}

void DrawSeries::prepare(const TerrainSurface* terrain, const std::optional<OpenClOptions>& device,
                         Provenance& provenance) {
  const GridSpec& grid = regrid_.grid;
  constexpr std::uint64_t kBytesPerBin = 24;  // the elevation and the true position of a draw, at least
  require_memory(kBytesPerBin * grid.size(), config_.name() + ": gridding a draw to " + size_text(grid),
                 "choose a smaller half_width_m or larger bins");
  const std::string eval = config_.name() + ": /eval";
  const std::optional<BinMask> mask =
      read_region(region_config(config_.stages().eval, eval),
                  {"the DEM", grid, scene_.crs_wkt, false, source_.rules, source_.warn}, eval, provenance);
  const EvaluationParameters evaluation = evaluation_config(config_.stages().eval, eval);
  at_path(eval + "/", [&] { region_ = judged_region(evaluation, grid, mask ? &*mask : nullptr); });
  runner_ = std::make_unique<DrawRunner>(
      DrawsScene{
          {truth_.ranges_m, truth_.echoes, truth_.later}, terrain, grid, region_, hazard_region(provenance)},
      config_.has_layers(), device);
  if (!config_.predicted()) return;
  const Simulation first = terrain_of(config_.stages(), 0).simulate(setup_of(config_.stages(), 0).scan);
  z_sigma_abs_ = predicted_sigma(runner_->scene(), first, *config_.predicted()).z_abs;
}

std::optional<BinMask> DrawSeries::hazard_region(Provenance& provenance) const {
  if (!config_.has_hazards()) return std::nullopt;
  const std::string name = config_.name() + ": /hazard";
  return read_region(region_config(config_.stages().hazard, name),
                     {"the DEM", regrid_.grid, scene_.crs_wkt, true, source_.rules, source_.warn}, name,
                     provenance);
}

/// Before any draw is run.
void DrawSeries::require_device(const DrawSpan& span) const {
  for (std::int64_t draw = span.first; draw < span.end; ++draw) {
    DrawSetup setup = setup_of(config_.stages(draw), draw);
    try {
      runner_->check_device(std::move(setup));
    } catch (const UsageError& error) {
      throw UsageError(config_.name() + ": draw " + std::to_string(draw) + ": " + error.what(),
                       error.parameter());
    }
  }
}

Draws DrawSeries::empty(std::int64_t first) const {
  Draws draws;
  draws.table.first = first;
  draws.footprint_bins = config_.footprint_bins();
  if (pair_) draws.table.varied.push_back({kPairColumn, {}});
  for (const std::string& key : config_.varied_keys()) draws.table.varied.push_back({key, {}});
  if (config_.has_layers()) {
    draws.maps.emplace(regrid_.grid);
    draws.region = region_;
    if (const auto& z_true_map = runner_->z_true_map()) {
      draws.z_true_map.emplace(regrid_.grid);
      std::ranges::transform(z_true_map->values(), draws.z_true_map->values().begin(),
                             [](double z_m) { return static_cast<float>(z_m); });
    } else {
      draws.maps->e_map.reset();
    }
    draws.z_sigma_abs = z_sigma_abs_;
    if (config_.has_hazards()) draws.maps->safety.emplace(regrid_.grid);
  }
  return draws;
}

DrawSetup DrawSeries::setup_of(const DrawStages& stages, std::int64_t draw) const {
  const std::string name = "draw " + std::to_string(draw);
  Provenance tables;  // those of the scan, which are recorded already
  const RegridConfig regrid = regrid_config(stages.regrid, name);
  return {scan_model(stages.scan, name, recording_table_loader(tables)),
          regrid.method,
          regrid.truth_at,
          evaluation_config(stages.eval, name),
          stages.hazard.is_null() ? std::nullopt
                                  : std::optional(hazard_config(stages.hazard, name + ": /hazard")),
          landing_setup(stages.scan, draw),
          uncertainty_of(config_, stages, name)};
}

std::optional<LandingSetup> DrawSeries::landing_setup(const nlohmann::json& scan, std::int64_t draw) const {
  if (!config_.landing()) return std::nullopt;
  LandingSetup setup{*config_.landing(), config_.seed(draw)};
  const nlohmann::json& error = scan.at("navigation_error");
  if (!error.contains("table"))
    setup.velocity_error_mps = {error.at("velocity_mps").at(0).get<double>(),
                                error.at("velocity_mps").at(1).get<double>()};
  return setup;
}

void DrawSeries::complete(Draws& draws) {
  const std::vector<std::int64_t> kept = std::exchange(on_device_, {});
  if (kept.empty() || runner_->take_from_device(std::ssize(kept), *draws.maps)) return;
  for (const std::int64_t draw : kept) static_cast<void>(run(draw, draws));  // by the CPU
}

DrawResult DrawSeries::run(std::int64_t draw, Draws& draws) {
  const DrawStages stages = config_.stages(draw);
  DrawResult result = naming_draw(config_, draw, [&] {
    DrawSetup setup = setup_of(stages, draw);
    const DrawTerrain terrain = terrain_of(stages, draw);
    return at_path(config_.name() + ": /hazard/", [&] {
      return runner_->run(std::move(setup), terrain, config_.metrics(), draws.maps ? &*draws.maps : nullptr);
    });
  });
  if (result.is_on_device) on_device_.push_back(draw);
  return result;
}

void DrawSeries::run_next(Draws& draws) {
  DrawTable& table = draws.table;
  const std::int64_t draw = table.end() - pair_.value_or(0) * config_.draw_count();
  std::vector<double> values = config_.values(draw);
  if (pair_) values.insert(values.begin(), static_cast<double>(*pair_));
  const DrawResult result = run(draw, draws);
  const std::optional<bool> pass = std::visit([](const auto& kind) { return kind.pass; }, result.metrics);
  add_to(table.metrics, flat_metrics(result));
  for (std::size_t i = 0; i < values.size(); ++i) table.varied[i].values.push_back(values[i]);
  const bool hazards_pass = !result.hazards || all_pass(result.hazards->score.own_requirements);
  table.pass.push_back(pass_flag(hazards_pass ? pass : std::optional(false)));
  table.seeds.push_back(static_cast<std::int64_t>(config_.seed(draw).seed));
  table.draws.push_back(draw);
}

}  // namespace landfall
