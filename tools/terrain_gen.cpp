// SPDX-License-Identifier: GPL-3.0-or-later
// terrain-gen: builds the true terrain of a landing site.
#include <variant>

#include "cli/tool.h"
#include "config/terrain_config.h"
#include "io/terrain_file.h"
#include "terrain/gdal_loader.h"
#include "terrain/terrain_generator.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  terrain-gen -c terrain.json -o terrain.h5
  terrain-gen -o slope.h5 --set base.slope_x=0.1 --set 'features=[{"type":"cone","radius_m":3,"height_m":10}]'
  terrain-gen -o europa.h5 --set 'base={"type":"dem","path":"europa.tif"}' --set grid.resolution_m=0.1
Configuration: docs/terrain-gen.md and --print-schema.)";

std::vector<std::string> raster_paths(const TerrainModel& model) {
  std::vector<std::string> paths;
  for (const Base& base : model.bases)
    if (const auto* const dem = std::get_if<DemBase>(&base)) paths.push_back(dem->path);
  return paths;
}

void count_holes(cli::Session& session, const Grid<double>& nodes) {
  std::int64_t holes = 0;
  for (const double z : nodes.values()) holes += std::isnan(z) ? 1 : 0;
  session.count("node_count", nodes.spec().size());
  session.count("hole_node_count", holes);
}

void count_features(cli::Session& session, const std::vector<PlacedFeature>& features) {
  std::vector<std::int64_t> counts(feature_kinds().size());
  for (const PlacedFeature& placed : features) ++counts[placed.feature.shape.index()];
  nlohmann::json by_kind = nlohmann::json::object();
  for (std::size_t kind = 0; kind < counts.size(); ++kind)
    if (counts[kind] > 0) by_kind[feature_kinds()[kind]] = counts[kind];
  session.count("feature_count", features.size());
  session.count("feature_count_by_kind", std::move(by_kind));
}

ExitCode run(cli::Session& session) {
  const TerrainConfig config = terrain_config(session.config(), session.config_name());
  const OutputOptions output = session.output(raster_paths(config.model));
  Provenance provenance = session.provenance();
  const DemLoader load = [&](const DemBase& dem, const GridSpec& site) {
    DemRaster raster = load_dem(dem, site);
    provenance.add_input("raster", raster_id(raster), nlohmann::json::array());
    return raster;
  };
  GeneratedTerrain terrain;
  session.phase("terrain", [&](const ProgressCallback& progress) {
    terrain = generate_terrain(config.model, config.grid, load, progress);
  });
  LandfallFileWriter file(output, "terrain", provenance);
  session.phase("write", [&](const ProgressCallback&) { write_terrain(file, terrain); });
  count_holes(session, terrain.nodes);
  count_features(session, terrain.features);
  return ExitCode::done;
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  cli::Tool tool;
  tool.name = "terrain-gen";
  tool.summary =
      "Builds the true terrain of a landing site: planes, fractals, imported DEMs, and features on them.";
  tool.examples = kExamples;
  tool.schema = "terrain";
  tool.has_seed = true;
  tool.bind = [](CLI::App&) {};
  tool.check = [](const cli::Session& s) { static_cast<void>(terrain_config(s.config(), s.config_name())); };
  tool.run = run;
  return cli::tool_main(argc, argv, tool);
}
