// SPDX-License-Identifier: GPL-3.0-or-later
// monte-carlo: draws a scan or its errors many times, and counts how often its DEM passes.
#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>
#include <vector>

#include "app/cli/draws_options.h"
#include "app/cli/meeting_options.h"
#include "app/cli/outcomes.h"
#include "app/cli/result_tables.h"
#include "app/cli/tool.h"
#include "app/exports/terrain_output.h"
#include "app/report/draws_page.h"
#include "app/runs/draw_series.h"
#include "app/runs/draws_run.h"
#include "base/core/standard_streams.h"
#include "store/config/dem_config.h"
#include "store/config/draws_config.h"
#include "store/config/import_config.h"
#include "store/config/stage_sections.h"
#include "store/files/draws_verdict.h"
#include "store/files/table_reader.h"
#include "tools.h"

namespace landfall::monte_carlo {
namespace {

constexpr const char* kExamples = R"(Examples:
  monte-carlo scan.h5 --terrain terrain.h5 -c mc.json -o draws.h5
  monte-carlo scan.h5 --terrain terrain.h5 -o draws.h5 --set draws=473 \
    --set scan.noise.range_sigma_m=0.02 --set metrics=verdict --table
  monte-carlo scan.h5 --terrain terrain.h5 -c mc.json --samples lhs.csv \
    -o draws.h5
  monte-carlo -c traced.json --terrain terrain.h5 -o draws.h5
  monte-carlo --pair a/scan.h5:a/terrain.h5 --pair b/scan.h5:b/terrain.h5 \
    -c mc.json -o draws.h5
  monte-carlo scan.h5 --terrain terrain.h5 -c mc.json -o a.h5 --draws 0:150
  monte-carlo merge a.h5 b.h5 -o draws.h5
Exit status 3: --require-pass is given, and a draw fails, or the sequential
test does not accept.
Configuration: --print-schema, man monte-carlo, docs/user/monte-carlo.md.)";

constexpr const char* kDescription =
    R"(Draws the errors of a traced scan many times, builds the DEM of each draw and judges it by the landing requirements, in memory: the true ranges are read once. Draw i gives the same metrics, bit for bit, as scan-sim --ranges-from scan.h5 --set draw=i, regrid and dem-eval --metrics-only.

Without a scan each draw traces its own rays, so that any key may vary: trajectory, pointing, scanner, and the ground itself, which --terrain or the section terrain gives. Draw i then equals terrain-gen, scan-sim, regrid and dem-eval with its number and values.

The output has one row per draw, and maps: the probability that a bin is empty and that a footprint exceeds a limit, mean and standard deviation of the errors. The table says how many draws passed each requirement and what probability of passing follows.

A run that was ended resumes when it is started again with the same configuration. --draws A:B runs a part; merge joins the parts of one run. With --pair, repeated, the draws run over several scans: a verdict for each and one for all of them, and no maps.)";

void check_config(const cli::Session& session, const cli::DrawsOptions& o) {
  if (o.merges()) return;
  std::optional<NumberTable> samples;
  if (!o.samples.empty()) samples = read_number_table(o.samples, {.all = true});
  check_draws_config(session.config(), session.config_name(), !o.traces(), samples ? &*samples : nullptr);
}

void write_report(OutputPath& file, const std::string& title, const Draws& draws,
                  const nlohmann::ordered_json& verdict, const Provenance& provenance) {
  const EvaluationParameters parameters =
      evaluation_config(provenance.config.at("eval"), "monte-carlo: /eval");
  const bool traces =
      std::ranges::find(provenance.inputs, "scan", &InputRecord::role) == provenance.inputs.end();
  write_text(file, html_report::draws_page({draws, verdict, parameters, traces}, provenance, title));
}

ExitCode conclude(cli::Session& session, const cli::DrawsOptions& o, const nlohmann::ordered_json& verdict) {
  session.count("verdict", verdict);
  if (session.options().shows_table(o.table)) standard_output() << cli::draws_table(verdict);
  const nlohmann::ordered_json& all = verdict.at("rates").back();
  const bool passed =
      verdict.contains("sprt") ? verdict.at("sprt") == "accepted" : all.at("passed") == all.at("draws");
  const bool refused = o.require_pass && !passed;
  session.conclude(cli::draws_summary(verdict), refused);
  return refused ? ExitCode::requirement_missed : ExitCode::done;
}

/// After the draws themselves, which the verdict describes.
void commit_verdict(const std::unique_ptr<OutputPath>& file, const nlohmann::ordered_json& verdict) {
  if (!file) return;
  write_text(*file, verdict.dump(2) + "\n");
  file->commit();
}

ExitCode merge(cli::Session& session, const cli::DrawsOptions& o) {
  const std::vector<std::string> parts(o.inputs.begin() + 1, o.inputs.end());
  const OutputOptions output = session.output(parts);
  const auto report_file = session.side_output("--report", o.report, parts);
  const auto verdict_file = session.side_output("--verdict", o.verdict, parts);
  Provenance provenance{.tool = session.tool()};
  MergedDraws merged;
  session.phase("merge", [&](const ProgressCallback&) { merged = merge_draws(parts, provenance); });
  const nlohmann::ordered_json verdict = verdict_json(merged.draws.table, std::nullopt);
  session.phase("write", [&](const ProgressCallback&) {
    LandfallFileWriter file(output, "draws", provenance);
    if (report_file) write_report(*report_file, o.title, merged.draws, verdict, provenance);
    write_draws(file, merged.draws, verdict, merged.crs_wkt);
    if (report_file) report_file->commit();
    commit_verdict(verdict_file, verdict);
  });
  return conclude(session, o, verdict);
}

ExitCode run(cli::Session& session, const cli::DrawsOptions& o) {
  cli::check_draws_options(session.options(), o);
  if (o.merges()) return merge(session, o);
  DrawsSources sources = o.sources();
  sources.make_terrain = [&o](const TerrainConfig& config, Provenance& provenance, const auto& warn) {
    return make_terrain(config, o.rules, provenance, warn);
  };
  const std::optional<DrawSpan> part = o.part();
  std::vector<std::string> inputs = {sources.samples};
  for (const ScanPair& pair : sources.pairs) inputs.insert(inputs.end(), {pair.scan, pair.terrain});
  const OutputOptions output = session.output(inputs);
  const auto report_file = session.side_output("--report", o.report, inputs);
  const auto verdict_file = session.side_output("--verdict", o.verdict, inputs);
  Provenance base = session.provenance();
  cli::add_meeting_options(base.options, o.rules);
  DrawsOutput draws_output{output,
                           session.config(),
                           std::move(base),
                           session.config_name(),
                           session.phases(),
                           [&](const std::string& text) { session.warn(text); },
                           [&](const std::string& text) { session.log(text); },
                           [&](const std::string& text) { session.note(text); },
                           [&] { return session.elapsed_s(); }};
  if (report_file)
    draws_output.report = [&](const Draws& draws, const nlohmann::ordered_json& verdict,
                              const Provenance& provenance) {
      write_report(*report_file, o.title, draws, verdict, provenance);
    };
  const DrawsSummary result = run_draws(sources, part, std::move(draws_output));
  if (report_file) report_file->commit();
  commit_verdict(verdict_file, result.verdict);
  session.count("draws_per_s", result.draws_per_s);
  if (sources.device) cli::report_draw_device(session, *sources.device->use);
  return conclude(session, o, result.verdict);
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  cli::DrawsOptions options;
  cli::Tool tool("monte-carlo");
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.has_seed = true;
  tool.seed_key = "/scan/seed";
  tool.bind = [&](CLI::App& app) { cli::bind_draws_options(app, options); };
  tool.expand = [](JsonSource& source, const cli::CommonOptions&) { expand_stage_sections(source); };
  tool.complete = [](JsonSource& source) {
    expand_stage_sections(source);
    fill_area(source.value, false);
    import_terrain(source,
                   [](const DemBase& dem, const SiteRequest& request) { return fit_site_of(dem, request); });
  };
  tool.check = [&](const cli::Session& session) { check_config(session, options); };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::monte_carlo
