// SPDX-License-Identifier: GPL-3.0-or-later
// regrid: builds a DEM from the returns of one or more scans.
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "cli/tool.h"
#include "config/config_path.h"
#include "config/dem_config.h"
#include "config/uncertainty_config.h"
#include "files/dem_file.h"
#include "files/scan_gridding.h"
#include "files/scan_poses.h"
#include "scene/scene.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  regrid scan.h5 --terrain terrain.h5 -o dem.h5
  regrid first.h5 second.h5 -c regrid.json --terrain terrain.h5 -o merged.h5
  regrid scan.h5 -o highest.h5 --method max
  regrid scan.h5 -o dem.h5 --set resolution_m=0.1 --layers z_est,count
  regrid scan.h5 --terrain terrain.h5 -o dem.h5 --uncertainty \
    --navigation-sigma velocity_mps=0.3,0.3,0.7
Without --terrain there is no z_true.
Configuration: --print-schema, man regrid, docs/user/regrid.md.)";

constexpr const char* kDescription =
    R"(Grids the estimated points of one or more scans: each return contributes to the bin with the nearest centre, weighted by its distance from that centre, or according to another method. With the terrain, the DEM also holds the true elevation of each bin, which dem-eval compares with the estimate.

--uncertainty adds the one-sigma map of the elevations by error propagation, --corrected the elevations moved along the local slope to the bin centres.)";

struct Options {
  std::vector<std::string> scans;
  std::string terrain;
  std::string layers_text;
  std::vector<std::string> layers;
  std::string truth_at;
  std::string method;
  bool other_terrain = false;
  bool corrected = false;
  bool uncertainty = false;
  std::optional<double> range_sigma_m;
  std::vector<std::string> navigation_sigmas;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("scans", o.scans, "Scans to grid (scan.h5)")->type_name("FILE...");
  app.add_option("--terrain", o.terrain, "True terrain (terrain.h5), for the layer z_true")
      ->type_name("FILE");
  app.add_option("--layers", o.layers_text, "Write only these layers, comma-separated")
      ->type_name("NAME,...")
      ->each([&o](const std::string& text) { o.layers = CLI::detail::split(text, ','); });
  app.add_option("--truth-at", o.truth_at,
                 "Position at which z_true is taken: bin_center or centroid; overrides the configuration")
      ->check(CLI::IsMember({"bin_center", "centroid"}));
  app.add_option("--method", o.method, "Gridding method; overrides the configuration")
      ->check(CLI::IsMember({"bilinear_nearest", "bilinear4", "mean", "min", "max", "median"}));
  app.add_flag("--other-terrain", o.other_terrain, "Accept a --terrain other than the one that was scanned");
  app.add_flag("--corrected", o.corrected,
               "Also write z_corrected: z_est moved along the local slope to the bin centre");
  app.add_flag("--uncertainty", o.uncertainty,
               "Also write the 1-sigma map: z_sigma_abs, z_sigma_rel, xy_sigma, z_true_map");
  app.add_option(
         "--range-sigma", o.range_sigma_m,
         "Standard deviation of the range noise for --uncertainty, metres; default: that of the scans")
      ->type_name("METRES")
      ->needs("--uncertainty");
  app.add_option("--navigation-sigma", o.navigation_sigmas,
                 "Standard deviation of a navigation error for --uncertainty, one number or x,y,z; KEY is "
                 "position_m, "
                 "velocity_mps, rpy_rad or rpy_rate_radps; repeatable")
      ->type_name("KEY=SIGMA")
      ->needs("--uncertainty")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

/// The configuration with the options that set its values, so that the provenance in the file is
/// complete.
nlohmann::json config_of(const cli::Session& session, const Options& o) {
  nlohmann::json config = session.config();
  if (!o.truth_at.empty()) config["truth_at"] = o.truth_at;
  if (o.range_sigma_m) config["uncertainty"]["range_sigma_m"] = *o.range_sigma_m;
  for (const std::string& sigma : o.navigation_sigmas) add_navigation_sigma(config, sigma);
  if (!o.method.empty()) config["method"] = o.method;
  return config;
}

nlohmann::json content_options(const Options& o) {
  nlohmann::json options;
  if (!o.layers.empty()) options["layers"] = o.layers;
  if (o.corrected) options["corrected"] = true;
  if (o.uncertainty) options["uncertainty"] = true;
  return options;
}

RegridConfig checked_config(const cli::Session& session, const Options& o) {
  const RegridConfig config = regrid_config(config_of(session, o), session.config_name());
  if ((o.uncertainty || o.corrected) && config.method != Method::bilinear_nearest)
    throw UsageError("--uncertainty and --corrected need the method bilinear_nearest");
  return config;
}

/// True if the scan's history names another terrain.
bool saw_other_terrain(const nlohmann::json& scan_chain, const std::string& terrain_id) {
  for (const nlohmann::json& step : scan_chain)
    if (step.value("tool", "") == "terrain-gen") return step.value("file_id", "") != terrain_id;
  return false;
}

/// All inputs of the DEM, opened and checked before the work begins.
struct Inputs {
  std::vector<std::unique_ptr<ScanReader>> scans;
  Scene scene;  ///< has no surface if no terrain is given
  std::optional<UncertaintyParameters> uncertainty;
  std::optional<PoseTrack> poses;
  Provenance provenance;
};

void open_uncertainty(const cli::Session& session, Inputs& inputs) {
  std::vector<ScanOrigin> origins;
  std::vector<ScanPoses> poses;
  for (const auto& scan : inputs.scans) {
    origins.push_back({scan->file().name(), scan->file().config()});
    poses.push_back(read_scan_poses(scan->file()));
  }
  inputs.uncertainty = uncertainty_parameters(inputs.provenance.config, session.config_name(), origins);
  at_path("--uncertainty: ", [&] { inputs.poses.emplace(std::move(poses)); });
  inputs.provenance.config["uncertainty"] = uncertainty_json(*inputs.uncertainty);
}

void open_terrain(cli::Session& session, const Options& o, Inputs& inputs) {
  session.phase("terrain", [&](const ProgressCallback& progress) {
    inputs.scene = open_scene({.terrain = o.terrain, .use = SceneUse::surface}, progress);
  });
  inputs.provenance.add_input("terrain", inputs.scene.file_id, inputs.scene.chain);
  for (const auto& scan : inputs.scans)
    if (!o.other_terrain && saw_other_terrain(scan->file().chain(), inputs.scene.file_id))
      throw FormatError(scan->file().name() + ": is a scan of another terrain than " + o.terrain +
                        "; give the scanned one, or --other-terrain");
}

Inputs open_inputs(cli::Session& session, const Options& o) {
  Inputs inputs;
  inputs.provenance = session.provenance();
  inputs.provenance.config = config_of(session, o);
  inputs.provenance.options = content_options(o);
  for (const std::string& path : o.scans) {
    inputs.scans.push_back(std::make_unique<ScanReader>(path));
    const LandfallFileReader& file = inputs.scans.back()->file();
    inputs.provenance.add_input("scan", file.file_id(), file.chain());
  }
  if (o.uncertainty) open_uncertainty(session, inputs);
  if (!o.terrain.empty()) open_terrain(session, o, inputs);
  return inputs;
}

/// The data from which the layers of --corrected and --uncertainty are computed.
struct ErrorMaps {
  Grid<Slope> slopes;
  std::optional<UncertaintyMap> uncertainty;  ///< refers to the slopes
};

void make_error_maps(cli::Session& session, const Options& o, const Inputs& inputs, const GriddedScans& scans,
                     ErrorMaps& maps) {
  if (!o.uncertainty && !o.corrected) return;
  session.phase("slope", [&](const ProgressCallback& progress) {
    maps.slopes = slope_layer(*scans.nearest, progress);
  });
  if (!o.uncertainty) return;
  session.phase("uncertainty", [&](const ProgressCallback& progress) {
    maps.uncertainty.emplace(*scans.nearest, *scans.moments, maps.slopes, *inputs.poses, *inputs.uncertainty,
                             progress);
  });
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.scans.empty()) throw UsageError("a scan to grid is required");
  const RegridConfig config = checked_config(session, o);
  std::vector<std::string> inputs_named = o.scans;
  inputs_named.push_back(o.terrain);
  const OutputOptions output = session.output(inputs_named);
  const Inputs inputs = open_inputs(session, o);
  const GridSpec& grid = config.grid;
  if (inputs.scene.window)
    inputs.scene.window->require({grid.x(0), grid.x(grid.cols - 1), grid.y(0), grid.y(grid.rows - 1)});
  DemRequest request{o.layers, inputs.scene.surface.get(), config.truth_at, o.uncertainty, o.corrected};
  check_layers(request);
  LandfallFileWriter file(output, "dem", inputs.provenance);
  GriddedScans scans;
  session.phase("grid", [&](const ProgressCallback& progress) {
    scans = grid_scans(inputs.scans, {grid, config.method, o.uncertainty}, progress);
  });
  ErrorMaps maps;
  make_error_maps(session, o, inputs, scans, maps);
  request.slopes = &maps.slopes;
  request.uncertainty_map = maps.uncertainty ? &*maps.uncertainty : nullptr;
  session.phase("write", [&](const ProgressCallback& progress) {
    write_dem(file, *scans.bins, request, inputs.scans.front()->crs_wkt(), progress);
  });
  session.count("inside_count", scans.bins->inside_count());
  session.count("outside_count", scans.bins->outside_count());
  return ExitCode::done;
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  Options options;
  cli::Tool tool;
  tool.name = "regrid";
  tool.summary =
      "Grids the returns of one or more scans into a DEM, with the true elevations if the terrain is given.";
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.schema = "regrid";
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.check = [&](const cli::Session& session) { static_cast<void>(checked_config(session, options)); };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool);
}
