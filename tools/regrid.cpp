// SPDX-License-Identifier: GPL-3.0-or-later
// regrid: gathers the returns of one or more scans into a DEM.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "base/parallel.h"
#include "cli/tool.h"
#include "config/dem_config.h"
#include "gridding/bin_accumulator.h"
#include "io/dem_file.h"
#include "io/scan_file.h"
#include "io/terrain_file.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  regrid scan.h5 --terrain terrain.h5 -o dem.h5
  regrid first.h5 second.h5 -c regrid.json --terrain terrain.h5 -o merged.h5
  regrid scan.h5 -o dem.h5 --set resolution_m=0.1 --layers z_est,count
Without --terrain there is no z_true. Configuration: docs/regrid.md and --print-schema.)";

/// Rows read at a time: 4 chunks of the file, 15 MB.
constexpr std::size_t kBatchRows = 4 * kTableChunkRows;

struct Options {
  std::vector<std::string> scans;
  std::string terrain;
  std::string layers_text;
  std::vector<std::string> layers;
  std::string truth_at;
  bool other_terrain = false;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("scans", o.scans, "Scans to grid (scan.h5)")->type_name("FILE...");
  app.add_option("--terrain", o.terrain, "True terrain, for the layer z_true")->type_name("FILE");
  app.add_option("--layers", o.layers_text, "Write only these layers, comma-separated")
      ->type_name("NAME,...")
      ->each([&o](const std::string& text) { o.layers = CLI::detail::split(text, ','); });
  app.add_option("--truth-at", o.truth_at,
                 "Where z_true is taken: bin_center or centroid; wins over the config")
      ->check(CLI::IsMember({"bin_center", "centroid"}));
  app.add_flag("--other-terrain", o.other_terrain, "Allow a --terrain that is not the one that was scanned");
}

/// The configuration with --truth-at in it, so that the file's provenance tells what was done.
nlohmann::json config_of(const cli::Session& session, const Options& o) {
  nlohmann::json config = session.config();
  if (!o.truth_at.empty()) config["truth_at"] = o.truth_at;
  return config;
}

/// True where the scan's history names a terrain, and it is another one.
bool saw_other_terrain(const nlohmann::json& scan_chain, const std::string& terrain_id) {
  for (const nlohmann::json& step : scan_chain)
    if (step.value("tool", "") == "terrain-gen") return step.value("file_id", "") != terrain_id;
  return false;
}

/// Everything that goes into the DEM, opened and checked before the work begins.
struct Inputs {
  std::vector<std::unique_ptr<ScanReader>> scans;
  std::optional<TerrainInput> terrain;
  Provenance provenance;
};

Inputs open_inputs(cli::Session& session, const Options& o) {
  Inputs inputs;
  inputs.provenance = session.provenance();
  inputs.provenance.config = config_of(session, o);
  if (!o.layers.empty()) inputs.provenance.options = {{"layers", o.layers}};
  for (const std::string& path : o.scans) {
    inputs.scans.push_back(std::make_unique<ScanReader>(path));
    const LandfallFileReader& file = inputs.scans.back()->file();
    inputs.provenance.add_input("scan", file.file_id(), file.chain());
  }
  if (o.terrain.empty()) return inputs;
  session.phase("terrain", [&](const ProgressCallback&) { inputs.terrain = read_terrain(o.terrain); });
  inputs.provenance.add_input("terrain", inputs.terrain->file_id, inputs.terrain->chain);
  for (const auto& scan : inputs.scans)
    if (!o.other_terrain && saw_other_terrain(scan->file().chain(), inputs.terrain->file_id))
      throw FormatError(scan->file().name() + ": scanned another terrain than " + o.terrain +
                        "; give that one, or --other-terrain");
  return inputs;
}

struct Batch {
  ScanReader* scan;
  std::size_t begin;
  std::size_t count;
};

std::vector<Batch> batches(const Inputs& inputs) {
  std::vector<Batch> result;
  for (const auto& scan : inputs.scans)
    for (std::size_t begin = 0; begin < scan->row_count(); begin += kBatchRows)
      result.push_back({scan.get(), begin, std::min(kBatchRows, scan->row_count() - begin)});
  return result;
}

/// Bins a batch while the next one is read.
void grid_scans(const Inputs& inputs, BinAccumulator& bins, const ProgressCallback& progress) {
  const std::vector<Batch> todo = batches(inputs);
  std::array<ScanPoints, 2> slots;
  read_ahead(
      todo.size(), slots.size(),
      [&](std::size_t i, std::size_t slot) { todo[i].scan->read(todo[i].begin, todo[i].count, slots[slot]); },
      [&](std::size_t i, std::size_t slot) {
        const ScanPoints& p = slots[slot];
        bins.add({p.x_est, p.y_est, p.z_est, p.x_true, p.y_true, p.z_true, p.t},
                 static_cast<std::int64_t>(todo[i].begin));
        report(progress, static_cast<double>(i + 1) / static_cast<double>(todo.size()));
      });
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.scans.empty()) throw UsageError("a scan to grid is required");
  const RegridConfig config = regrid_config(config_of(session, o), session.config_name());
  std::vector<std::string> inputs_named = o.scans;
  inputs_named.push_back(o.terrain);
  const OutputOptions output = session.output(inputs_named);
  Inputs inputs = open_inputs(session, o);
  const DemRequest request{o.layers, inputs.terrain ? inputs.terrain->surface.get() : nullptr,
                           config.truth_at};
  check_layers(request);
  LandfallFileWriter file(output, "dem", inputs.provenance);
  BinAccumulator bins(config.grid);
  session.phase("grid", [&](const ProgressCallback& progress) { grid_scans(inputs, bins, progress); });
  session.phase("write", [&](const ProgressCallback& progress) {
    write_dem(file, bins, request, inputs.scans.front()->crs_wkt(), progress);
  });
  session.count("inside_count", bins.inside_count());
  session.count("outside_count", bins.outside_count());
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
      "Gathers the returns of one or more scans into a DEM, with its truth where the terrain is given.";
  tool.examples = kExamples;
  tool.schema = "regrid";
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.check = [&](const cli::Session& s) {
    static_cast<void>(regrid_config(config_of(s, options), s.config_name()));
  };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool);
}
