// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D321
#include "app/runs/draw_series.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/runs/redraw.h"
#include "app/runs/region_input.h"
#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/memory/available_memory.h"
#include "base/raster/grid_spec.h"
#include "base/text/number_text.h"
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
  constexpr std::int64_t kPulsesAtOnce = 4096;
  RangeFile file(scan.file().name());
  const nlohmann::json& detector = scan.file().config().at("detector");
  const auto pixels = detector.at("rows").get<std::size_t>() * detector.at("columns").get<std::size_t>();
  const auto pulses = static_cast<std::int64_t>(scan.pulse_count());
  DrawsTruth truth;
  truth.ranges_m.resize(scan.pulse_count() * pixels);
  if (file.keeps_echoes()) truth.echoes.resize(truth.ranges_m.size());
  for (std::int64_t first = 0; first < pulses; first += kPulsesAtOnce) {
    const RecordedRanges piece = file.read({first, std::min(kPulsesAtOnce, pulses - first)}, pixels);
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
auto naming_draw(const DrawsConfig& config, std::int64_t draw, const Work& work) {
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
  open_terrain(SceneUse::surface, false, provenance);
  require_same_rays(scan, terrains_.front().scene, config, span);
  truth_ = read_truth(scan, progress);
  require_hazards(config, span);
  prepare(terrains_.front().scene.surface.get(), device, provenance);
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
    open_terrain(SceneUse::rays, uses_albedo_map(scan), provenance);
  } else {
    const UsedMemory before = used_memory();
    build_terrain(config.stages(span.first).terrain, terrains_.front(), provenance);
    terrains_.front().draw = span.first;
    if (config.terrain_varies()) terrain_bytes_ = used_memory().peak - before.now;
    source_.warn = [](const std::string&) {};  // of later terrains, which are alike
  }
  prepare(config.terrain_varies() ? nullptr : terrains_.front().scene.surface.get(), std::nullopt,
          provenance);
}

void DrawSeries::open_terrain(SceneUse use, bool uses_albedo, Provenance& provenance) {
  Scene& scene = terrains_.front().scene;
  scene = open_scene({.terrain = source_.terrain, .use = use});
  provenance.add_input("terrain", scene.file_id, scene.chain);
  const GridSpec& grid = regrid_.grid;
  if (scene.window)
    scene.window->require({grid.x(0), grid.x(grid.cols - 1), grid.y(0), grid.y(grid.rows - 1)});
  if (uses_albedo) terrains_.front().albedo = open_albedo(source_.terrain);
}

void DrawSeries::build_terrain(const nlohmann::json& config, Terrain& terrain, Provenance& provenance) const {
  terrain = {};  // the old one first, so that both never exist at once
  const TerrainInput made =
      source_.make(terrain_config(config, config_.name() + ": /terrain"), provenance, source_.warn);
  terrain.scene = traced_scene(made);
  if (made.grid) terrain.scene.spacing_m = node_spacing_m(config, made.grid->nodes().spec().resolution_m);
  terrain.albedo = made.albedo;
}

DrawTerrain DrawSeries::terrain_of(const DrawStages& stages, std::int64_t draw, Terrain& terrain) const {
  if (config_.terrain_varies() && draw != terrain.draw) {
    Provenance recorded;  // with the first terrain
    build_terrain(stages.terrain, terrain, recorded);
    terrain.draw = draw;
  }
  const Scene& scene = terrain.scene;
  return {*scene.surface, scene.engine.get(), terrain.albedo.get(), scene.spacing_m};
}

void DrawSeries::prepare(const TerrainSurface* terrain, const std::optional<OpenClOptions>& device,
                         Provenance& provenance) {
  crs_wkt_ = terrains_.front().scene.crs_wkt;
  const GridSpec& grid = regrid_.grid;
  constexpr std::uint64_t kBytesPerBin = 24;  // the elevation and the true position of a draw, at least
  require_memory(kBytesPerBin * grid.size(), config_.name() + ": gridding a draw to " + size_text(grid),
                 "choose a smaller half_width_m or larger bins");
  const std::string eval = config_.name() + ": /eval";
  const std::optional<BinMask> mask =
      read_region(region_config(config_.stages().eval, eval),
                  {"the DEM", grid, crs_wkt_, false, source_.rules, source_.warn}, eval, provenance);
  const EvaluationParameters evaluation = evaluation_config(config_.stages().eval, eval);
  BinMask region;
  at_path(eval + "/", [&] { region = judged_region(evaluation, grid, mask ? &*mask : nullptr); });
  DrawsScene scene{{truth_.ranges_m, truth_.echoes, truth_.later},
                   terrain,
                   grid,
                   std::move(region),
                   hazard_region(provenance)};
  scene_ = config_.has_layers() ? with_maps(std::move(scene)) : std::move(scene);
  lanes_.emplace_back(terrains_.front(), *scene_, device);
  is_shaped_ = device || thread_count() == 1;
  if (!config_.predicted()) return;
  const Simulation first =
      terrain_of(config_.stages(), 0, terrains_.front()).simulate(setup_of(config_.stages(), 0).scan);
  predicted_sigma_ = predicted_sigma(*scene_, first, *config_.predicted()).z_abs;
}

std::optional<BinMask> DrawSeries::hazard_region(Provenance& provenance) const {
  if (!config_.has_hazards()) return std::nullopt;
  const std::string name = config_.name() + ": /hazard";
  return read_region(region_config(config_.stages().hazard, name),
                     {"the DEM", regrid_.grid, crs_wkt_, true, source_.rules, source_.warn}, name,
                     provenance);
}

/// Before any draw is run.
void DrawSeries::require_device(const DrawSpan& span) const {
  for (std::int64_t draw = span.first; draw < span.end; ++draw) {
    DrawSetup setup = setup_of(config_.stages(draw), draw);
    try {
      lanes_.front().runner.check_device(std::move(setup));
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
    draws.region = scene_->region;
    if (const auto& map_truth = scene_->map_truth) {
      draws.map_truth.emplace(regrid_.grid);
      std::ranges::transform(map_truth->values(), draws.map_truth->values().begin(),
                             [](double z_m) { return static_cast<float>(z_m); });
    } else {
      draws.maps->e_map.reset();
    }
    draws.predicted_sigma = predicted_sigma_;
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
  Lane& lane = lanes_.front();
  if (kept.empty() || lane.runner.take_from_device(std::ssize(kept), *draws.maps)) return;
  for (const std::int64_t draw : kept) {  // by the CPU
    make(draw, lane);
    add_to_maps(draw, lane, *draws.maps);
  }
}

void DrawSeries::run(Draws& draws, std::int64_t count, const DrawsControl& control) {
  if (count > 1 && !is_shaped_) {
    const UsedMemory before = used_memory();
    if (!run_on_lanes(draws, 1, control)) return;
    choose_lanes(before, control);
    --count;
  }
  run_on_lanes(draws, count, control);
}

void DrawSeries::choose_lanes(const UsedMemory& before, const DrawsControl& control) {
  const std::uint64_t bytes_each = used_memory().peak - before.now + terrain_bytes_;
  shape_ = draw_lanes(thread_count(), bytes_each, available_memory());
  is_shaped_ = true;
  control.log("makes " + std::to_string(shape_.draws) + " draws at a time on " +
              std::to_string(thread_count()) + " threads; each needs " +
              number_text(std::round(static_cast<double>(bytes_each) / 1e6)) + " MB");
  while (lanes_.size() < shape_.draws)
    lanes_.emplace_back(config_.terrain_varies() ? terrains_.emplace_back() : terrains_.front(), *scene_,
                        std::nullopt);
}

/// Returns false if not all were added.
bool DrawSeries::run_on_lanes(Draws& draws, std::int64_t count, const DrawsControl& control) {
  const std::int64_t first = draws.table.end() - pair_.value_or(0) * config_.draw_count();
  return make_draws(count, shape_,
                    {control.begins, [&](std::int64_t i, std::size_t lane) { make(first + i, lanes_[lane]); },
                     [&](std::int64_t i, std::size_t lane) {
                       add(first + i, lanes_[lane], draws);
                       return control.added();
                     }});
}

void DrawSeries::make(std::int64_t draw, Lane& lane) const {
  const DrawStages stages = config_.stages(draw);
  lane.result = naming_draw(config_, draw, [&] {
    DrawSetup setup = setup_of(stages, draw);
    const DrawTerrain terrain = terrain_of(stages, draw, lane.terrain);
    return at_path(config_.name() + ": /hazard/", [&] {
      return lane.runner.run(std::move(setup), terrain, config_.metrics(), lane.layers);
    });
  });
}

void DrawSeries::add_to_maps(std::int64_t draw, const Lane& lane, DrawMaps& maps) const {
  naming_draw(config_, draw,
              [&] { maps.add(lane.layers, scene_->map_truth ? &*scene_->map_truth : nullptr); });
}

void DrawSeries::add(std::int64_t draw, const Lane& lane, Draws& draws) {
  const DrawResult& result = lane.result;
  if (result.is_on_device)
    on_device_.push_back(draw);
  else if (draws.maps)
    add_to_maps(draw, lane, *draws.maps);
  DrawTable& table = draws.table;
  std::vector<double> values = config_.values(draw);
  if (pair_) values.insert(values.begin(), static_cast<double>(*pair_));
  const std::optional<bool> pass = std::visit([](const auto& kind) { return kind.pass; }, result.metrics);
  add_to(table.metrics, flat_metrics(result));
  for (std::size_t i = 0; i < values.size(); ++i) table.varied[i].values.push_back(values[i]);
  const bool hazards_pass = !result.hazards || all_pass(result.hazards->score.own_requirements);
  table.pass.push_back(pass_flag(hazards_pass ? pass : std::optional(false)));
  table.seeds.push_back(static_cast<std::int64_t>(config_.seed(draw).seed));
  table.draws.push_back(draw);
}

}  // namespace landfall
