// SPDX-License-Identifier: GPL-3.0-or-later
// scan-sim: scans a terrain with a lander's lidar.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "base/parameter_check.h"
#include "cli/plan_table.h"
#include "cli/tool.h"
#include "config/scan_config.h"
#include "files/number_table.h"
#include "files/plan_file.h"
#include "files/range_file.h"
#include "files/scan_file.h"
#include "files/terrain_file.h"
#include "ray/cgal_engine.h"
#include "ray/flat_ground.h"
#include "ray/heightfield_engine.h"
#include "ray/windowed_terrain.h"
#include "simulation/scan_pipeline.h"
#include "simulation/scan_plan.h"
#include "terrain/relief/triangulated_grid.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  scan-sim -c scan.json --terrain terrain.h5 -o scan.h5
  scan-sim -c scan.json --terrain terrain.h5 -o noisy.h5 --set noise.range_sigma_m=0.0167 --seed 7
  scan-sim --terrain terrain.h5 -o flash.h5 --set 'scanner={"type":"flash"}' --set detector.rows=128
  scan-sim -c scan.json --ranges-from scan.h5 -o draw2.h5 --seed 2 --set noise.range_sigma_m=0.02
  scan-sim -c scan.json --plan -o plan.h5
Configuration: --print-schema, man scan-sim, docs/scan-sim.md.)";

constexpr const char* kDescription =
    R"(Simulates a lander's scanning lidar pulse by pulse: trajectory and attitude, scanner, detector, rays to the terrain, range noise, and what the lander's navigation believes. The output has one row per return with its true and its estimated point, one per pulse with the poses, and one per pixel.

--ranges-from takes the true ranges of an earlier scan and draws only the errors anew, without tracing. --plan traces nothing either: it tells how the scan's time is spent and what it would cover of flat ground.)";

struct Options {
  std::string terrain;
  std::string ranges_from;
  std::string engine = "auto";
  std::int64_t batch_points = 16384;
  bool keep_misses = false;
  bool float32 = false;
  bool plan = false;
  double plan_radius_m = 50;
  double plan_resolution_m = 0.05;
};

void bind_plan(CLI::App& app, Options& o) {
  CLI::Option* const plan = app.add_flag(
      "--plan", o.plan,
      "Trace nothing: print what the scan would cover of flat ground (z = 0) and how its time is spent; -o "
      "writes the coverage as layers");
  app.add_option("--plan-radius", o.plan_radius_m, "Region of a plan, metres about the origin")
      ->type_name("M")
      ->needs(plan)
      ->capture_default_str();
  app.add_option("--plan-resolution", o.plan_resolution_m, "Bins of a plan, metres")
      ->type_name("M")
      ->needs(plan)
      ->capture_default_str();
}

void bind(CLI::App& app, Options& o) {
  app.add_option("--terrain", o.terrain, "Terrain to scan (terrain.h5)")->type_name("FILE");
  app.add_option("--engine", o.engine,
                 "Ray engine: heightfield (fast, grids only), cgal (AABB tree, exact predicates; slow, much "
                 "memory), or "
                 "auto: cgal on a mesh, else heightfield. Their ranges agree within 1e-9 m")
      ->check(CLI::IsMember({"auto", "heightfield", "cgal"}))
      ->capture_default_str();
  app.add_option("--ranges-from", o.ranges_from,
                 "Take the true ranges of an earlier scan (scan.h5) and draw only the errors anew; --terrain "
                 "is needed "
                 "only for noise that depends on the incidence")
      ->type_name("FILE");
  app.add_option("--batch-points", o.batch_points,
                 "Points that one thread works on at a time: more take more memory, the result is the same")
      ->type_name("N")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  app.add_flag("--keep-misses", o.keep_misses, "A row per pixel and pulse, not only per return");
  app.add_flag("--float32", o.float32, "Coordinates and ranges in single precision");
  bind_plan(app, o);
}

/// Reads the tables that a configuration names, and enters them into the provenance.
TableLoader table_loader(Provenance& provenance) {
  return [&provenance](const std::string& path, const std::string& role, const TableColumns& columns) {
    provenance.add_input(role, content_id(path), nlohmann::json::array());
    return read_number_table(path, columns);
  };
}

/// The name of the engine that `asked` stands for on this terrain.
std::string engine_name(const std::string& asked, const TerrainInput& terrain) {
  if (terrain.mesh && asked == "heightfield")
    throw UsageError("--engine heightfield: the terrain is a mesh, which it cannot trace; use cgal or auto");
  if (asked != "auto") return asked;
  return terrain.mesh ? "cgal" : "heightfield";
}

std::unique_ptr<const RayEngine> make_engine(const std::string& name, const TerrainInput& terrain,
                                             const ProgressCallback& progress) {
  if (terrain.mesh) return make_cgal_engine(terrain.mesh, progress);
  return name == "cgal" ? make_cgal_engine(terrain.grid, progress)
                        : make_heightfield_engine(terrain.grid, progress);
}

/// `trace_s`: how long tracing took; none where the ranges came from a file.
void count_rays(cli::Session& session, const Simulation& simulation, std::optional<double> trace_s) {
  const std::int64_t rays =
      simulation.pulse_count() * static_cast<std::int64_t>(simulation.detector().samples().size());
  session.count("pulse_count", simulation.pulse_count());
  session.count("ray_count", rays);
  if (trace_s) session.count("rays_per_s", static_cast<double>(rays) / *trace_s);
  session.count("real_time_factor", simulation.duration_s() / session.elapsed_s());
}

void count_points(cli::Session& session, const ScanWriter& writer) {
  for (const PointStatusInfo& info : kPointStatuses)
    if (info.is_counted()) session.count(info.count_name, writer.count(info.status));
}

/// The options that change what the scan file holds; null where none does.
nlohmann::json options_json(const Options& o) {
  nlohmann::json options;
  if (o.keep_misses) options["keep_misses"] = true;
  if (o.float32) options["float32"] = true;
  return options;
}

/// Stands for the engine of a run that takes its ranges from a file.
class NoEngine final : public RayEngine {
 public:
  void first_hits(std::span<const Ray>, std::span<double>) const override {
    throw std::logic_error("a replayed scan traced a ray");
  }
};

/// True where the errors need the terrain itself, not only the ranges to it.
bool needs_surface(const nlohmann::json& config) { return config.at("noise").at("incidence_sigma_rad") != 0; }

/// The terrain to scan; of a run that takes its ranges from a file, only its name unless its errors need
/// more.
TerrainInput open_terrain(cli::Session& session, const Options& o, const std::optional<RangeFile>& ranges) {
  TerrainInput terrain;
  if (ranges) terrain = ranges->terrain();
  if (o.terrain.empty() && needs_surface(session.config()))
    throw UsageError("--terrain is required with --ranges-from where /noise/incidence_sigma_rad is not 0");
  if (o.terrain.empty()) return terrain;
  if (ranges && !needs_surface(session.config())) {
    const LandfallFileReader named(o.terrain, {"terrain"});
    terrain.file_id = named.file_id();
    terrain.chain = named.chain();
  } else {
    session.phase("terrain",
                  [&](const ProgressCallback& progress) { terrain = read_terrain(o.terrain, progress); });
  }
  return terrain;
}

/// A large terrain, of which only what the rays need is loaded.
struct Window {
  TerrainInput input;  ///< without its surface
  std::unique_ptr<const WindowedTerrain> terrain;
};

/// Nothing where the terrain is loaded whole, or its ranges come from a file.
std::optional<Window> open_window(cli::Session& session, const Options& o) {
  if (!o.ranges_from.empty()) return std::nullopt;
  std::optional<LargeTerrainInput> large;
  session.phase("open", [&](const ProgressCallback& progress) {
    large = open_large_terrain(o.terrain, kMaxLoadedNodes, progress);
  });
  if (!large) return std::nullopt;
  TerrainInput input{nullptr, nullptr, nullptr, large->crs_wkt, large->file_id, large->chain};
  const std::string name = engine_name(o.engine, input);
  session.count("engine", name);
  const auto make = [name](const std::shared_ptr<const TriangulatedGrid>& grid) {
    return make_engine(name, {grid, grid, nullptr, "", "", nullptr}, {});
  };
  return Window{std::move(input), std::make_unique<const WindowedTerrain>(std::move(large->terrain), make)};
}

std::unique_ptr<const RayEngine> open_engine(cli::Session& session, const Options& o,
                                             const TerrainInput& terrain) {
  if (!o.ranges_from.empty()) {
    session.count("engine", "none");
    return std::make_unique<NoEngine>();
  }
  const std::string name = engine_name(o.engine, terrain);
  session.count("engine", name);
  std::unique_ptr<const RayEngine> engine;
  session.phase("engine",
                [&](const ProgressCallback& progress) { engine = make_engine(name, terrain, progress); });
  return engine;
}

/// The smallest grid of bins about the origin that holds the region.
GridSpec plan_grid(const Options& o) {
  require_positive({"", "--plan-radius"}, o.plan_radius_m);
  require_positive({"", "--plan-resolution"}, o.plan_resolution_m);
  const double bins = std::max(1.0, std::ceil(o.plan_radius_m / o.plan_resolution_m - 1e-9));
  return GridSpec::centered(bins * o.plan_resolution_m, o.plan_resolution_m,
                            "--plan-radius, --plan-resolution");
}

/// Coverage of the bins that have a return.
Coverage coverage_of(const ScanPlan& plan) {
  Grid<double> z_est(plan.region().spec());
  for (std::size_t i = 0; i < z_est.values().size(); ++i)
    if (plan.count().values()[i] == 0) z_est.values()[i] = std::numeric_limits<double>::quiet_NaN();
  return assess_coverage(z_est, plan.region(), {});
}

ExitCode run_plan(cli::Session& session, const Options& o) {
  if (!o.terrain.empty() || !o.ranges_from.empty())
    throw UsageError("--plan is made on flat ground: --terrain and --ranges-from have no part in it");
  Provenance provenance = session.provenance();
  provenance.options = {{"plan", {{"radius_m", o.plan_radius_m}, {"resolution_m", o.plan_resolution_m}}}};
  ScanPlan plan(circular_region(plan_grid(o), o.plan_radius_m));
  std::optional<LandfallFileWriter> file;
  ScanModel model = scan_model(session.config(), session.config_name(), table_loader(provenance));
  if (!session.options().output_path.empty()) file.emplace(session.output(), "plan", provenance);
  const double pulse_rate_hz = model.pulse_rate_hz;
  const FlatGround ground;
  constexpr double kBeyondAnyLander_m = 1e9;
  const TriangulatedGrid level(Grid<double>(GridSpec::centered(kBeyondAnyLander_m, kBeyondAnyLander_m)));
  const Simulation simulation(std::move(model), ground, &level);
  session.phase("plan", [&](const ProgressCallback& progress) {
    const auto add = [&](PulseBatch& batch) {
      plan.add(batch);
      return SinkWork{};
    };
    run_scan(simulation, {}, add, o.batch_points, progress);
  });
  nlohmann::ordered_json numbers;
  session.phase("coverage", [&](const ProgressCallback&) {
    const Coverage coverage = coverage_of(plan);
    numbers = plan_json(plan, coverage.metrics, o.plan_radius_m, pulse_rate_hz);
    if (file) write_plan(*file, plan, coverage.hole_id, numbers);
  });
  session.count("plan", numbers);
  if (!session.options().json_summary) std::cout << cli::plan_table(numbers);
  return ExitCode::done;
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.plan) return run_plan(session, o);
  if (o.terrain.empty() && o.ranges_from.empty()) throw UsageError("--terrain is required");
  const OutputOptions output = session.output({o.terrain, o.ranges_from});
  Provenance provenance = session.provenance();
  provenance.options = options_json(o);
  ScanModel model = scan_model(session.config(), session.config_name(), table_loader(provenance));
  std::optional<RangeFile> ranges;
  if (!o.ranges_from.empty()) ranges.emplace(o.ranges_from);
  const std::optional<Window> window = open_window(session, o);
  const TerrainInput terrain = window ? window->input : open_terrain(session, o, ranges);
  provenance.add_input("terrain", terrain.file_id, terrain.chain);
  if (ranges) ranges->require_match(provenance);
  LandfallFileWriter file(output, "scan", provenance);
  const std::unique_ptr<const RayEngine> engine = window ? nullptr : open_engine(session, o, terrain);
  const RayEngine& rays = window ? static_cast<const RayEngine&>(*window->terrain) : *engine;
  const TerrainSurface* const ground =
      window ? window->terrain.get() : static_cast<const TerrainSurface*>(terrain.surface.get());
  const Simulation simulation(std::move(model), rays, ground);
  Replay replay;
  if (ranges)
    replay.ranges = [&](PulseSpan pulses) { return ranges->ranges_m(pulses, simulation.pixel_count()); };
  ScanWriter writer(file, {o.keep_misses, o.float32}, terrain.crs_wkt);
  const bool same_rows = ranges && ranges->has_rows_of(session.config(), o.keep_misses);
  if (same_rows && writer.copy_truth(ranges->points())) replay.content = PointContent::estimate;
  const double scan_s = session.phase(ranges ? "replay" : "trace", [&](const ProgressCallback& progress) {
    run_scan(
        simulation, replay, [&](PulseBatch& batch) { return writer.take(batch); }, o.batch_points, progress);
  });
  if (window) {
    const GridSpec loaded = window->terrain->window();
    session.log("loaded " + std::to_string(loaded.cols) + " x " + std::to_string(loaded.rows) +
                " nodes of the terrain");
  }
  session.phase("finish", [&](const ProgressCallback&) {
    writer.commit(simulation.detector(), simulation.dead_map());
  });
  count_rays(session, simulation, ranges ? std::nullopt : std::optional(scan_s));
  count_points(session, writer);
  return ExitCode::done;
}

void check_config(const cli::Session& session) {
  static_cast<void>(scan_model(session.config(), session.config_name(), {}));
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  Options options;
  cli::Tool tool;
  tool.name = "scan-sim";
  tool.summary = "Scans a terrain with a lander's scanning lidar: true and estimated points of every return.";
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.schema = "scan";
  tool.has_seed = true;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.check = check_config;
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool);
}
