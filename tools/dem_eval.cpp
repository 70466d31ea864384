// SPDX-License-Identifier: GPL-3.0-or-later
// dem-eval: judges a DEM against the landing requirements.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "cli/tool.h"
#include "cli/verdict_table.h"
#include "config/dem_config.h"
#include "io/evaluation_file.h"
#include "io/metrics_json.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  dem-eval dem.h5 -o eval.h5 --metrics metrics.json
  dem-eval dem.h5 --metrics-only --require-pass > metrics.json
  dem-eval dem.h5 -o eval.h5 --table --set region_radius_m=40 --set limits.relative_elevation_m=0.03
Exit: 3 where --require-pass is given and a requirement is missed or cannot be judged.
Configuration: --print-schema, man dem-eval, docs/dem-eval.md.)";

constexpr const char* kDescription =
    R"(Compares a DEM with the truth that regrid wrote beside it, over a region about the intended landing site: share of bins without an elevation, size of the holes and distance across them, mean error and relative error of every footprint that a lander may stand on. Each is held against its limit.

The output has the error layers and a map of what fails where; --metrics writes the numbers as JSON, --table prints them.)";

struct Options {
  std::string dem;
  std::string metrics;
  bool metrics_only = false;
  bool require_pass = false;
  bool table = false;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("dem", o.dem, "DEM to judge (dem.h5)")->type_name("FILE");
  app.add_option("--metrics", o.metrics, "Write the metrics as JSON")->type_name("FILE");
  app.add_flag("--metrics-only", o.metrics_only,
               "Keep no layers; without -o and --metrics the metrics go to stdout");
  app.add_flag("--require-pass", o.require_pass, "Exit with 3 unless every requirement passes");
  app.add_flag("--table", o.table, "Print the table of requirements; the default on a terminal");
}

/// The outputs of a run, refused before the DEM is read. They appear together or not at all.
class Outputs {
 public:
  Outputs(const cli::Session& session, const Options& o) {
    if (!o.metrics_only || !session.options().output_path.empty()) layers_ = session.output({o.dem});
    if (o.metrics.empty()) return;
    if (o.metrics == "-") throw UsageError("--metrics wants a file; --metrics-only alone prints the metrics");
    if (same_file(o.metrics, o.dem)) throw UsageError("--metrics names the DEM itself, " + o.metrics);
    if (layers_ && same_file(layers_->path, o.metrics))
      throw UsageError("-o and --metrics name the same file, " + o.metrics);
    metrics_ = std::make_unique<OutputPath>(o.metrics, session.options().overwrite);
  }

  void open(const Provenance& provenance, const DemInput& dem) {
    if (!layers_) return;
    file_ = std::make_unique<LandfallFileWriter>(*layers_, "evaluation", provenance);
    writer_.emplace(*file_, dem.layers.z_est.spec(), dem.crs_wkt);
  }

  /// Takes the layers; null where there is no file to write.
  LayerSink* sink() { return writer_ ? &*writer_ : nullptr; }

  void finish(const Evaluation& evaluation) {
    if (metrics_) write_text(*metrics_, metrics_json(evaluation.metrics).dump(2) + "\n");
    if (writer_) writer_->finish(evaluation);
    if (metrics_) metrics_->commit();
  }

 private:
  std::optional<OutputOptions> layers_;
  std::unique_ptr<LandfallFileWriter> file_;
  std::optional<EvaluationWriter> writer_;
  std::unique_ptr<OutputPath> metrics_;
};

void print_result(const cli::Session& session, const Options& o, const Evaluation& evaluation,
                  const EvaluationParameters& parameters) {
  const bool metrics_to_stdout = o.metrics_only && o.metrics.empty() && session.options().output_path.empty();
  if (metrics_to_stdout && !session.options().json_summary && !o.table) {
    std::cout << metrics_json(evaluation.metrics).dump(2) << '\n';
  } else if (o.table ||
             (isatty(STDOUT_FILENO) != 0 && !session.options().quiet && !session.options().json_summary)) {
    std::cout << cli::verdict_table(metrics_json(evaluation.metrics), parameters.limits);
  }
}

ExitCode verdict(const cli::Session& session, const Options& o, const Metrics& metrics) {
  if (!o.require_pass || metrics.pass.value_or(false)) return ExitCode::done;
  std::string names;
  for (const std::string& name : cli::missed_requirements(metrics_json(metrics)))
    names += (names.empty() ? "" : ", ") + name;
  if (!session.options().quiet)
    std::cerr << session.tool() << ": " << o.dem << ": missed or not judged: " << names << '\n';
  return ExitCode::requirement_missed;
}

/// A refusal names both the configuration and the DEM that do not go together.
Evaluation judge_dem(const cli::Session& session, const Options& o, DemLayers dem,
                     const EvaluationParameters& parameters, LayerSink* sink,
                     const ProgressCallback& progress) {
  try {
    return evaluate(std::move(dem), parameters, sink, progress);
  } catch (const UsageError& error) {
    throw UsageError(session.config_name() + ": /" + error.what() + " (" + o.dem + ")");
  } catch (const FormatError& error) {
    throw FormatError(o.dem + ": " + error.what());
  }
}

/// Nothing for a DEM without 1-sigma maps.
std::optional<UncertaintyMetrics> judge_uncertainty(const Options& o, const EvaluationParameters& parameters,
                                                    std::optional<BinMask> region_mask) {
  std::optional<UncertaintyLayers> layers = read_uncertainty(o.dem);
  if (!layers) return std::nullopt;
  const GridSpec spec = layers->error.spec();
  const BinMask region = judged_region(
      {.z_est = Grid<double>(spec), .truth = {}, .region_mask = std::move(region_mask)}, parameters);
  return assess_uncertainty(*layers, region, footprint_of(parameters, spec.resolution_m));
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.dem.empty()) throw UsageError("a DEM to judge is required");
  if (o.metrics_only && !session.options().view_path.empty())
    throw UsageError("--metrics-only keeps no layers for --view to show");
  if (o.table && session.options().json_summary) throw UsageError("--table and --json both want stdout");
  const EvaluationParameters parameters = evaluation_config(session.config(), session.config_name());
  Outputs outputs(session, o);
  DemInput dem;
  session.phase("read", [&](const ProgressCallback&) { dem = read_dem(o.dem); });
  Provenance provenance = session.provenance();
  if (o.metrics_only) provenance.options = {{"metrics_only", true}};
  provenance.add_input("dem", dem.file_id, dem.chain);
  if (const auto source = region_mask_source(session.config())) {
    RegionMask region = read_region_mask(source->path, source->layer, dem.layers.z_est.spec());
    provenance.add_input("region", region.file_id, nlohmann::json::array());
    dem.layers.region_mask = std::move(region.mask);
  }
  outputs.open(provenance, dem);
  LayerSink* const sink = o.metrics_only ? nullptr : outputs.sink();
  std::optional<BinMask> region_mask = dem.layers.region_mask;
  Evaluation evaluation;
  session.phase("evaluate", [&](const ProgressCallback& progress) {
    evaluation = judge_dem(session, o, std::move(dem.layers), parameters, sink, progress);
  });
  session.phase("uncertainty", [&](const ProgressCallback&) {
    evaluation.metrics.uncertainty = judge_uncertainty(o, parameters, std::move(region_mask));
  });
  session.phase("write", [&](const ProgressCallback&) { outputs.finish(evaluation); });
  session.count("metrics", metrics_json(evaluation.metrics));
  print_result(session, o, evaluation, parameters);
  return verdict(session, o, evaluation.metrics);
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  Options options;
  cli::Tool tool;
  tool.name = "dem-eval";
  tool.summary =
      "Judges a DEM against landing requirements: coverage, holes, absolute and relative accuracy.";
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.schema = "eval";
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.check = [](const cli::Session& s) {
    static_cast<void>(evaluation_config(s.config(), s.config_name()));
  };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool);
}
