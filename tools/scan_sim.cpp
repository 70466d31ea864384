// SPDX-License-Identifier: GPL-3.0-or-later
// scan-sim: scans a terrain with a lander's lidar.
#include <CLI/CLI.hpp>
#include <map>
#include <memory>

#include "app/cli/outcomes.h"
#include "app/cli/plan.h"
#include "app/cli/tool.h"
#include "app/runs/redraw.h"
#include "app/runs/scene.h"
#include "chain/lidar/error_models/range_errors.h"
#include "chain/lidar/simulation/scan_pipeline.h"
#include "store/config/receiver_config.h"
#include "store/config/scan_config.h"
#include "store/files/range_file.h"
#include "store/files/scan_file.h"
#include "store/files/table_reader.h"
#include "tools.h"

namespace landfall::scan_sim {
namespace {

constexpr const char* kExamples = R"(Examples:
  scan-sim -c preset:paper --terrain terrain.h5 -o scan.h5
  scan-sim -c scan.json --terrain terrain.h5 -o noisy.h5 \
    --set noise.range_sigma_m=0.0167 --seed 7
  scan-sim --terrain terrain.h5 -o flash.h5 --set detector.rows=128 \
    --set 'scanner={"type":"flash"}'
  scan-sim -c scan.json --ranges-from scan.h5 -o draw2.h5 --seed 2
  scan-sim -c scan.json --plan -o plan.h5
Configuration: --print-schema, man scan-sim, docs/user/scan-sim.md.)";

constexpr const char* kDescription =
    R"(Simulates a lander's scanning lidar pulse by pulse: trajectory and attitude, scanner, detector, rays to the terrain, range noise, and navigation errors. The output has one row per return with its true and its estimated point, one per pulse with the poses, and one per pixel.

--ranges-from takes the true ranges from an earlier scan and redraws only the errors, without tracing. --plan does not trace rays either: it reports the time budget of the scan and its coverage of flat terrain.)";

struct Options {
  std::string terrain;
  std::string ranges_from;
  std::string engine = "auto";
  std::int64_t batch_points = 16384;
  bool keep_misses = false;
  bool keep_echoes = false;
  bool float32 = false;
  cli::PlanOptions plan;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("--terrain", o.terrain, "Terrain to scan (terrain.h5)")->type_name("FILE");
  app.add_option(
         "--engine", o.engine,
         "Ray engine: heightfield (fast, grids only), cgal (AABB tree with exact predicates; slower, needs "
         "more memory), or auto (cgal for a mesh, otherwise heightfield). Ranges agree within 1e-9 m")
      ->check(CLI::IsMember({"auto", "heightfield", "cgal"}))
      ->capture_default_str();
  app.add_option(
         "--ranges-from", o.ranges_from,
         "Take the true ranges from an earlier scan (scan.h5) and redraw only the errors; --terrain is "
         "needed only if the noise depends on the incidence angle")
      ->type_name("FILE");
  app.add_option("--batch-points", o.batch_points,
                 "Points per batch of a thread; affects memory and speed, not the result")
      ->type_name("N")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  app.add_flag("--keep-misses", o.keep_misses, "Write a row per pixel and pulse, not only per return");
  app.add_flag("--keep-echoes", o.keep_echoes,
               "Write the echoes of every pixel, from which --ranges-from redraws the errors of a receiver");
  app.add_flag("--float32", o.float32, "Write coordinates and ranges in single precision");
  cli::bind_plan(app, o.plan);
}

/// The options that change the content of the scan file; null if none does.
nlohmann::json options_json(const Options& o) {
  nlohmann::json options;
  if (o.keep_misses) options["keep_misses"] = true;
  if (o.keep_echoes) options["keep_echoes"] = true;
  if (o.float32) options["float32"] = true;
  return options;
}

EngineKind engine_kind(const std::string& name) {
  return name == "heightfield" ? EngineKind::heightfield
         : name == "cgal"      ? EngineKind::cgal
                               : EngineKind::automatic;
}

/// Ranges from a file need no terrain, unless the errors depend on its surface.
Scene scanned_scene(cli::Session& session, const Options& o, const RangeFile* ranges, bool needs_surface) {
  if (ranges != nullptr && o.terrain.empty()) {
    if (needs_surface)
      throw UsageError(session.config_name() + ": /noise/" + kIncidenceNoise + ": " +
                       session.config().at("noise").at(kIncidenceNoise).dump() +
                       " with --ranges-from needs --terrain");
    return {ranges->terrain()};
  }
  SceneRequest request{o.terrain};
  if (ranges != nullptr) request.use = needs_surface ? SceneUse::surface : SceneUse::identity;
  request.engine = engine_kind(o.engine);
  Scene scene;
  session.phase("terrain", [&](const ProgressCallback& progress) { scene = open_scene(request, progress); });
  return scene;
}

void require_echoes_to_keep(const Receiver& receiver, const std::string& config_name) {
  if (!receiver.uses_waveforms())
    throw UsageError(config_name + ": /receiver/type: \"none\" has no echoes for --keep-echoes");
  if (!receiver.accepts_kept_echoes())
    throw UsageError(
        config_name +
        ": /receiver: --keep-echoes keeps the echoes of first, last and strongest; /receiver/type "
        "geiger and /receiver/returns all need whole waveforms");
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.plan.requested) {
    if (!o.terrain.empty() || !o.ranges_from.empty())
      throw UsageError("--plan uses flat terrain; omit --terrain and --ranges-from");
    return cli::run_plan(session, o.plan, o.batch_points);
  }
  if (o.terrain.empty() && o.ranges_from.empty()) throw UsageError("--terrain is required");
  const OutputOptions output = session.output({o.terrain, o.ranges_from});
  Provenance provenance = session.provenance();
  provenance.options = options_json(o);
  ScanModel model = scan_model(session.config(), session.config_name(), recording_table_loader(provenance));
  std::unique_ptr<RangeFile> ranges;
  if (!o.ranges_from.empty()) ranges = std::make_unique<RangeFile>(o.ranges_from);
  if (o.keep_echoes) require_echoes_to_keep(model.lidar.receiver, session.config_name());
  const Scene scene = scanned_scene(session, o, ranges.get(), model.lidar.range_errors.needs_incidence());
  session.count("engine", scene.engine_name);
  provenance.add_input("terrain", scene.file_id, scene.chain);
  if (ranges) require_redraw(*ranges, provenance);
  LandfallFileWriter file(output, "scan", provenance);
  std::unique_ptr<const AlbedoMap> albedo;
  if (uses_albedo_map(session.config()) && !ranges) albedo = open_albedo(o.terrain);
  const Simulation simulation(std::move(model), scene.engine.get(), scene.surface.get(), albedo.get());
  Replay replay{.keep_echoes = o.keep_echoes};
  if (ranges)
    replay.ranges = [&](PulseSpan pulses) { return ranges->read(pulses, simulation.pixel_count()); };
  ScanWriter writer(file, {o.keep_misses, o.float32, simulation.columns(o.keep_echoes)}, scene.crs_wkt);
  const bool same_rows = ranges && has_rows_of(*ranges, session.config(), o.keep_misses);
  if (same_rows && writer.copy_truth(ranges->points())) replay.content = PointContent::estimate;
  const double scan_s = session.phase(ranges ? "replay" : "trace", [&](const ProgressCallback& progress) {
    run_scan(
        simulation, replay, [&](PulseBatch& batch) { return writer.take(batch); }, o.batch_points, progress);
  });
  if (scene.window)
    session.log("loaded " + std::to_string(scene.window->window().size()) + " nodes of the terrain");
  session.phase("finish", [&](const ProgressCallback&) {
    writer.commit(simulation.detector(), simulation.dead_map());
  });
  if (scene.engine) session.count("rays_per_s", static_cast<double>(simulation.ray_count()) / scan_s);
  cli::report_scan(session, simulation, writer);
  return ExitCode::done;
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  Options options;
  cli::Tool tool("scan-sim");
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.has_seed = true;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.check = [](cli::Session& session) {
    static_cast<void>(scan_model(session.config(), session.config_name(), {}));
    for (const auto& warnings : {pointing_warnings(session.config()), receiver_warnings(session.config())})
      for (const std::string& warning : warnings) session.warn(warning);
  };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::scan_sim
