// SPDX-License-Identifier: GPL-3.0-or-later
// dem-eval: judges a DEM against the landing requirements.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include "app/cli/judged_region.h"
#include "app/cli/meeting_options.h"
#include "app/cli/outcomes.h"
#include "app/cli/result_tables.h"
#include "app/cli/tool.h"
#include "app/report/evaluation_page.h"
#include "base/core/standard_streams.h"
#include "formats/gdal/gdal_loader.h"
#include "store/config/dem_config.h"
#include "store/files/evaluation_file.h"
#include "store/files/metrics_json.h"
#include "tools.h"

namespace landfall::dem_eval {
namespace {

constexpr const char* kExamples = R"(Examples:
  dem-eval dem.h5 -o eval.h5 --metrics metrics.json
  dem-eval dem.h5 --report report.html
  dem-eval dem.h5 --metrics-only --require-pass > metrics.json
  dem-eval dem.h5 --table --set region_radius_m=40 \
    --set limits.relative_elevation_m=0.03
Exit status 3: --require-pass is given, and a requirement is missed or cannot
be judged.
Configuration: --print-schema, man dem-eval, docs/user/dem-eval.md.)";

constexpr const char* kDescription =
    R"(Compares a DEM with its truth layers in a region around the intended landing site, and judges each requirement by its limit: fraction of bins without an elevation, size of the holes, distance to the nearest valid bin, mean error and relative error of every lander footprint.

The output has the error layers and the layer fail, which marks the missed requirements; --metrics writes the numbers as JSON, --table prints them.)";

struct Options {
  std::string dem, metrics, report, title;
  bool metrics_only = false;
  bool require_pass = false;
  bool table = false;
  MeetingRules rules;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("dem", o.dem, "DEM to judge (dem.h5)")->type_name("FILE");
  app.add_option("--metrics", o.metrics, "Write the metrics as JSON")->type_name("FILE");
  app.add_option("--report", o.report, "Write a report: one HTML file with verdicts, maps and a 3-D view")
      ->type_name("FILE");
  app.add_option("--title", o.title, "Title of the report; default: the site and the lidar in words")
      ->type_name("TEXT");
  app.add_flag("--metrics-only", o.metrics_only,
               "Write no layers; without -o, --metrics and --report the metrics go to stdout: JSON, or the "
               "table on a terminal");
  app.add_flag("--require-pass", o.require_pass, "Exit with 3 unless every requirement passes");
  app.add_flag("--table", o.table, "Print the table of requirements; default on a terminal");
  cli::bind_meeting_options(app, o.rules);
}

void check(const cli::CommonOptions& common, const Options& o) {
  if (o.dem.empty()) throw UsageError("a DEM to judge is required");
  if (o.metrics_only && !common.view_path.empty())
    throw UsageError("--view shows a layer, which --metrics-only does not write");
  if (o.table && common.json_summary) throw UsageError("--table and --json both write to standard output");
  const bool has_output = !o.metrics.empty() || !o.report.empty() || !common.output_path.empty();
  if (!o.metrics_only && !has_output && !common.shows_table(o.table))
    throw UsageError("nothing to write; give -o, --metrics, --report, --table or --metrics-only");
  if (o.metrics == "-") throw UsageError("--metrics needs a file; --metrics-only alone prints the metrics");
  if (!o.title.empty() && o.report.empty()) throw UsageError("--title needs --report");
  if (o.report == "-") throw UsageError("--report needs a file");
}

/// The DEM and, if the configuration has one, the mask of its region.
DemInput read_inputs(cli::Session& session, const Options& o, Provenance& provenance,
                     const ProgressCallback& progress) {
  DemInput dem = read_dem(o.dem, progress);
  provenance.add_input("dem", dem.file_id, dem.chain);
  dem.layers.region_mask = cli::read_judged_region(
      session, {o.dem, dem.layers.z_est.spec(), dem.crs_wkt, false, o.rules}, provenance);
  return dem;
}

/// The table for a person, JSON for a program.
void print(const cli::CommonOptions& common, const Options& o, const Metrics& metrics,
           const EvaluationLimits& limits) {
  const bool has_file = !o.metrics.empty() || !o.report.empty() || !common.output_path.empty();
  if (o.metrics_only && !has_file && !common.json_summary && !o.table && isatty(STDOUT_FILENO) == 0)
    standard_output() << metrics_json(metrics).dump(2) << '\n';
  else if (common.shows_table(o.table))
    standard_output() << cli::verdict_table(metrics, limits);
}

ExitCode run(cli::Session& session, const Options& o) {
  check(session.options(), o);
  const EvaluationParameters parameters = evaluation_config(session.config(), session.config_name());
  // The outputs are refused before the DEM is read, and appear together or not at all.
  std::optional<OutputOptions> layers;
  if (!session.options().output_path.empty()) layers = session.output({o.dem});
  const auto metrics_file = session.side_output("--metrics", o.metrics, {o.dem});
  const auto report_file = session.side_output("--report", o.report, {o.dem});
  Provenance provenance = session.provenance();
  if (o.metrics_only) provenance.options = {{"metrics_only", true}};
  cli::add_meeting_options(provenance.options, o.rules);
  DemInput dem;
  session.phase(
      "read", [&](const ProgressCallback& progress) { dem = read_inputs(session, o, provenance, progress); });
  const GridSpec grid = dem.layers.z_est.spec();
  const BinBox scanned = valid_box(dem.layers.z_est);
  const bool from_import = is_imported(dem.chain);
  std::optional<EvaluationWriter> writer;
  std::optional<html_report::Report> report;
  std::vector<LayerSink*> sinks;
  if (layers) writer.emplace(*layers, provenance, grid, dem.crs_wkt);
  if (writer && !o.metrics_only) sinks.push_back(&*writer);
  if (report_file) sinks.push_back(&report.emplace(o.dem, dem.layers, dem.crs_wkt, parameters));
  if (const auto why = report_file ? no_map_positions(dem.crs_wkt) : std::nullopt)
    session.warn(o.dem + ": the report has no map coordinates: " + *why);
  Evaluation evaluation;
  session.phase("evaluate", [&](const ProgressCallback& progress) {
    const auto judge = [&] { evaluation = evaluate(std::move(dem.layers), parameters, sinks, progress); };
    session.with_file_names(o.dem, judge);
  });
  session.phase("uncertainty", [&](const ProgressCallback&) {
    if (const auto maps = dem.has_sigmas ? read_uncertainty(o.dem) : std::nullopt)
      evaluation.metrics.uncertainty =
          assess_uncertainty(*maps, evaluation.region, footprint_of(parameters, grid.resolution_m));
    judge_own_requirements(evaluation.metrics, parameters.own_requirements);
  });
  const nlohmann::ordered_json numbers = metrics_json(evaluation.metrics);
  session.phase("write", [&](const ProgressCallback&) {
    if (metrics_file) write_text(*metrics_file, numbers.dump(2) + "\n");
    if (report) write_text(*report_file, report->page(evaluation, provenance, o.title));
    if (writer) writer->finish(evaluation, parameters.limits);
    if (metrics_file) metrics_file->commit();
    if (report_file) report_file->commit();
  });
  session.count("metrics", numbers);
  cli::warn_of_assumptions(session, o.dem, evaluation.metrics, parameters, grid.resolution_m, from_import);
  print(session.options(), o, evaluation.metrics, parameters.limits);
  return cli::report_evaluation(session, o.dem, evaluation, scanned, o.require_pass);
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  Options options;
  cli::Tool tool("dem-eval");
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.check = [](const cli::Session& s) {
    static_cast<void>(evaluation_config(s.config(), s.config_name()));
  };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::dem_eval
