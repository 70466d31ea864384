// SPDX-License-Identifier: GPL-3.0-or-later
// dem-eval: judges a DEM against the landing requirements.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "cli/tool.h"
#include "cli/verdict_table.h"
#include "config/dem_config.h"
#include "files/evaluation_file.h"
#include "files/metrics_json.h"
#include "report/page.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  dem-eval dem.h5 -o eval.h5 --metrics metrics.json
  dem-eval dem.h5 -o eval.h5 --report report.html
  dem-eval dem.h5 --metrics-only --require-pass > metrics.json
  dem-eval dem.h5 -o eval.h5 --table --set region_radius_m=40 --set limits.relative_elevation_m=0.03
Exit: 3 where --require-pass is given and a requirement is missed or cannot be judged.
Configuration: --print-schema, man dem-eval, docs/user/dem-eval.md.)";

constexpr const char* kDescription =
    R"(Compares a DEM with the truth that regrid wrote beside it, over a region about the intended landing site: share of bins without an elevation, size of the holes and distance across them, mean error and relative error of every footprint that a lander may stand on. Each is held against its limit.

The output has the error layers and a map of what fails where; --metrics writes the numbers as JSON, --table prints them.)";

struct Options {
  std::string dem;
  std::string metrics;
  std::string report;
  bool metrics_only = false;
  bool require_pass = false;
  bool table = false;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("dem", o.dem, "DEM to judge (dem.h5)")->type_name("FILE");
  app.add_option("--metrics", o.metrics, "Write the metrics as JSON")->type_name("FILE");
  app.add_option("--report", o.report, "Write a report: one HTML file with verdicts, maps and a 3-D view")
      ->type_name("FILE");
  app.add_flag("--metrics-only", o.metrics_only,
               "Keep no layers; without -o, --metrics and --report the metrics go to stdout");
  app.add_flag("--require-pass", o.require_pass, "Exit with 3 unless every requirement passes");
  app.add_flag("--table", o.table, "Print the table of requirements; the default on a terminal");
}

/// Gives what an evaluation gives to each of several.
class SinkList : public LayerSink {
 public:
  void add(LayerSink* sink) {
    if (sink != nullptr) sinks_.push_back(sink);
  }
  [[nodiscard]] bool empty() const { return sinks_.empty(); }
  void take(const CoverageLayers& layers) override {
    for (LayerSink* const sink : sinks_) sink->take(layers);
  }
  void take(Axis axis, const AxisLayers& layers) override {
    for (LayerSink* const sink : sinks_) sink->take(axis, layers);
  }
  void take(const Grid<std::int8_t>& fail) override {
    for (LayerSink* const sink : sinks_) sink->take(fail);
  }

 private:
  std::vector<LayerSink*> sinks_;
};

/// The report of a run: its page is made at the end, of what it kept of the layers and of the DEM.
class ReportOutput {
 public:
  ReportOutput(const std::string& path, bool overwrite) : output_(path, overwrite) {}

  /// Before the DEM is judged.
  void open(const Options& o, const DemLayers& dem, const EvaluationParameters& parameters) {
    dem_.emplace(o.dem);
    layers_.emplace(dem.z_est.spec(), parameters);
    layers_->take(dem);
    if (const auto count = dem_->count()) layers_->take(*count);
  }

  LayerSink* sink() { return &*layers_; }

  void write(const Evaluation& evaluation, const EvaluationParameters& parameters,
             const Provenance& provenance) {
    nlohmann::json steps = provenance.chain;
    steps.push_back(provenance.as_step());
    const auto worst = html_report::worst_footprints(
        layers_->shares(), parameters, [this](const GridSpec& window) { return dem_->read(window); });
    write_text(output_, html_report::report_page({parameters, evaluation, *layers_, worst, steps}));
  }

  void commit() { output_.commit(); }

 private:
  OutputPath output_;
  std::optional<DemWindowReader> dem_;
  std::optional<html_report::ReportLayers> layers_;
};

/// The outputs of a run, refused before the DEM is read. They appear together or not at all.
class Outputs {
 public:
  Outputs(cli::Session& session, const Options& o) {
    if (!o.metrics_only && session.options().output_path.empty())
      throw UsageError("-o/--output is required; or give --metrics-only, which keeps no layers");
    if (!session.options().output_path.empty()) layers_ = session.output({o.dem});
    if (o.metrics == "-") throw UsageError("--metrics wants a file; --metrics-only alone prints the metrics");
    if (o.report == "-") throw UsageError("--report wants a file");
    if (!o.metrics.empty()) session.claim_output("--metrics", o.metrics, {o.dem});
    if (!o.report.empty()) session.claim_output("--report", o.report, {o.dem});
    const bool overwrite = session.options().overwrite;
    if (!o.metrics.empty()) metrics_ = std::make_unique<OutputPath>(o.metrics, overwrite);
    if (!o.report.empty()) report_ = std::make_unique<ReportOutput>(o.report, overwrite);
  }

  void open(const Options& o, const EvaluationParameters& parameters, const Provenance& provenance,
            const DemInput& dem) {
    if (layers_) {
      file_ = std::make_unique<LandfallFileWriter>(*layers_, "evaluation", provenance);
      writer_.emplace(*file_, dem.layers.z_est.spec(), dem.crs_wkt);
      if (!o.metrics_only) sinks_.add(&*writer_);
    }
    if (!report_) return;
    report_->open(o, dem.layers, parameters);
    sinks_.add(report_->sink());
  }

  /// Takes the layers; null where none are wanted.
  LayerSink* sink() { return sinks_.empty() ? nullptr : &sinks_; }

  void finish(const Evaluation& evaluation, const EvaluationParameters& parameters,
              const Provenance& provenance) {
    if (metrics_) write_text(*metrics_, metrics_json(evaluation.metrics).dump(2) + "\n");
    if (report_) report_->write(evaluation, parameters, provenance);
    if (writer_) writer_->finish(evaluation);
    if (metrics_) metrics_->commit();
    if (report_) report_->commit();
  }

 private:
  std::optional<OutputOptions> layers_;
  std::unique_ptr<LandfallFileWriter> file_;
  std::optional<EvaluationWriter> writer_;
  std::unique_ptr<OutputPath> metrics_;
  std::unique_ptr<ReportOutput> report_;
  SinkList sinks_;
};

void print_result(const cli::Session& session, const Options& o, const Evaluation& evaluation,
                  const EvaluationParameters& parameters) {
  const bool metrics_to_stdout =
      o.metrics_only && o.metrics.empty() && o.report.empty() && session.options().output_path.empty();
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
  outputs.open(o, parameters, provenance, dem);
  std::optional<BinMask> region_mask = dem.layers.region_mask;
  Evaluation evaluation;
  session.phase("evaluate", [&](const ProgressCallback& progress) {
    evaluation = judge_dem(session, o, std::move(dem.layers), parameters, outputs.sink(), progress);
  });
  session.phase("uncertainty", [&](const ProgressCallback&) {
    evaluation.metrics.uncertainty = judge_uncertainty(o, parameters, std::move(region_mask));
  });
  session.phase("write",
                [&](const ProgressCallback&) { outputs.finish(evaluation, parameters, provenance); });
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
