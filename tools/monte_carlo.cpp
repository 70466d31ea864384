// SPDX-License-Identifier: GPL-3.0-or-later
// monte-carlo: draws the errors of a scan many times, and counts how often its DEM passes.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "base/number_text.h"
#include "cli/draws_table.h"
#include "cli/tool.h"
#include "config/dem_config.h"
#include "config/draws_config.h"
#include "files/number_table.h"
#include "report/draws_page.h"
#include "scene/campaign.h"
#include "scene/campaign_run.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  monte-carlo scan.h5 --terrain terrain.h5 -c mc.json -o draws.h5
  monte-carlo scan.h5 --terrain terrain.h5 -o draws.h5 --set draws=473 \
    --set scan.noise.range_sigma_m=0.02 --set metrics=verdict --table
  monte-carlo scan.h5 --terrain terrain.h5 -c mc.json --samples lhs.csv \
    -o draws.h5
  monte-carlo --pair a/scan.h5:a/terrain.h5 --pair b/scan.h5:b/terrain.h5 \
    -c mc.json -o draws.h5
  monte-carlo scan.h5 --terrain terrain.h5 -c mc.json -o a.h5 --draws 0:150
  monte-carlo merge a.h5 b.h5 -o draws.h5
Exit status 3: --require-pass is given, and a draw fails, or the sequential
test does not accept.
Configuration: --print-schema, man monte-carlo, docs/user/monte-carlo.md.)";

constexpr const char* kDescription =
    R"(Draws the errors of a traced scan many times, builds the DEM of each draw and judges it by the landing requirements, in memory: the true ranges are read once. Draw i gives the same metrics, bit for bit, as scan-sim --ranges-from scan.h5 --seed (seed + i), regrid and dem-eval --metrics-only.

The output has one row per draw, and maps: the probability that a bin is empty and that a footprint exceeds a limit, mean and standard deviation of the errors. The table says how many draws passed each requirement and what probability of passing follows.

A run that was ended goes on where it was when it is started again with the same configuration. --draws A:B runs a part; merge joins the parts of one campaign. With --pair, repeated, the draws run over several scans: a verdict for each and one for all of them, and no maps.)";

struct Options {
  std::vector<std::string> inputs;  ///< a scan, or merge and parts
  CampaignSources sources;
  std::vector<std::string> pairs;
  std::string terrain, draws, verdict, report, title;
  bool table = false;
  bool require_pass = false;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("scan", o.inputs, "Traced scan (scan.h5); or: merge, and the parts of a campaign (draws.h5)")
      ->type_name("FILE...");
  app.add_option("--terrain", o.terrain, "Terrain that was scanned (terrain.h5)")->type_name("FILE");
  app.add_option("--pair", o.pairs, "A scan and its terrain, in place of scan and --terrain; repeated: draws over each")
      ->type_name("SCAN:TERRAIN")
      ->allow_extra_args(false);
  app.add_option("--samples", o.sources.samples,
                 "Values of varied keys, a column each and a row per draw (CSV or HDF5)")
      ->type_name("FILE");
  app.add_option("--draws", o.draws, "Run only a part, for merge: A:B, the draws A to B - 1")->type_name("RANGE");
  app.add_option("--verdict", o.verdict, "Write how many draws passed each requirement, with intervals, as JSON")
      ->type_name("FILE");
  app.add_option("--report", o.report,
                 "Write a report: one HTML file with maps, distributions and the failed draws")
      ->type_name("FILE");
  app.add_option("--title", o.title, "Title of the report; default: the site and the lidar in words")
      ->type_name("TEXT");
  app.add_flag("--table", o.table, "Print how many draws passed each requirement; default on a terminal");
  app.add_flag("--require-pass", o.require_pass,
               "Exit with 3 unless every draw passes, or the sequential test accepts");
}

ScanPair pair_of(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size())
    throw UsageError("--pair " + text + ": expected SCAN:TERRAIN");
  return {text.substr(0, colon), text.substr(colon + 1)};
}

DrawSpan span_of(const std::string& text) {
  DrawSpan span;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, span.first);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == ':') {
    const auto last = std::from_chars(first.ptr + 1, end, span.end);
    if (last.ec == std::errc() && last.ptr == end && span.first >= 0 && span.first < span.end) return span;
  }
  throw UsageError("--draws " + text + ": expected A:B with 0 <= A < B");
}

void check(const cli::CommonOptions& common, const Options& o, bool merges) {
  if (!o.pairs.empty() && (!o.inputs.empty() || !o.terrain.empty()))
    throw UsageError("--pair names scan and terrain; omit " + (o.inputs.empty() ? "--terrain" : o.inputs.front()));
  if (o.inputs.empty() && o.pairs.empty()) throw UsageError("a scan is required");
  if (o.table && common.json_summary) throw UsageError("--table and --json both write to standard output");
  if (!o.title.empty() && o.report.empty()) throw UsageError("--title needs --report");
  if (o.report == "-") throw UsageError("--report needs a file");
  if (o.verdict == "-") throw UsageError("--verdict needs a file; --json prints it");
  if (merges) {
    if (o.inputs.size() < 2) throw UsageError("merge needs the parts of a campaign");
    if (!o.terrain.empty() || !o.sources.samples.empty() || !o.draws.empty() ||
        !common.config_names.empty() || !common.assignments.empty())
      throw UsageError("merge takes all from its parts; omit --terrain, --samples, --draws, -c and --set");
    return;
  }
  if (o.inputs.size() > 1) throw UsageError("one scan at a time; " + o.inputs[1] + " is a second one");
  if (o.terrain.empty() && o.pairs.empty()) throw UsageError("--terrain is required");
}

void check_config(const cli::Session& session, const Options& o) {
  if (!o.inputs.empty() && o.inputs.front() == "merge") return;
  std::optional<NumberTable> samples;
  if (!o.sources.samples.empty()) samples = read_number_table(o.sources.samples, {.all = true});
  check_draws_config(session.config(), session.config_name(), samples ? &*samples : nullptr);
}

void write_report(OutputPath& file, const std::string& title, const Draws& draws,
                  const nlohmann::ordered_json& verdict, const Provenance& provenance) {
  const EvaluationParameters parameters = evaluation_config(provenance.config.at("eval"), "monte-carlo: /eval");
  write_text(file, html_report::draws_page({draws, verdict, parameters}, provenance, title));
}

ExitCode conclude(cli::Session& session, const Options& o, const nlohmann::ordered_json& verdict) {
  session.count("verdict", verdict);
  if (o.table || (isatty(STDOUT_FILENO) != 0 && !session.options().quiet && !session.options().json_summary))
    std::cout << cli::draws_table(verdict);
  const nlohmann::ordered_json& all = verdict.at("rates").back();
  const bool passed = verdict.contains("sprt") ? verdict.at("sprt") == "accepted" : all.at("passed") == all.at("draws");
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

ExitCode merge(cli::Session& session, const Options& o) {
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

ExitCode run(cli::Session& session, const Options& o) {
  const bool merges = !o.inputs.empty() && o.inputs.front() == "merge";
  check(session.options(), o, merges);
  if (merges) return merge(session, o);
  CampaignSources sources = o.sources;
  for (const std::string& pair : o.pairs) sources.pairs.push_back(pair_of(pair));
  if (sources.pairs.empty()) sources.pairs.push_back({o.inputs.front(), o.terrain});
  std::optional<DrawSpan> part;
  if (!o.draws.empty()) part = span_of(o.draws);
  std::vector<std::string> inputs = {sources.samples};
  for (const ScanPair& pair : sources.pairs) inputs.insert(inputs.end(), {pair.scan, pair.terrain});
  const OutputOptions output = session.output(inputs);
  const auto report_file = session.side_output("--report", o.report, inputs);
  const auto verdict_file = session.side_output("--verdict", o.verdict, inputs);
  CampaignOutput campaign{output,
                          session.provenance(),
                          session.config_name(),
                          session.phases(),
                          [&](const std::string& text) { session.warn(text); },
                          [&](const std::string& text) { session.log(text); },
                          [&](const std::string& text) { session.note(text); },
                          [&] { return session.elapsed_s(); }};
  if (report_file)
    campaign.report = [&](const Draws& draws, const nlohmann::ordered_json& verdict, const Provenance& provenance) {
      write_report(*report_file, o.title, draws, verdict, provenance);
    };
  const CampaignResult result = run_campaign(sources, part, std::move(campaign));
  if (report_file) report_file->commit();
  commit_verdict(verdict_file, result.verdict);
  session.count("draws_per_s", result.draws_per_s);
  return conclude(session, o, result.verdict);
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  Options options;
  cli::Tool tool;
  tool.name = "monte-carlo";
  tool.summary = "Draws the errors of a scan many times, and counts how often its DEM passes.";
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.schema = "draws";
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.check = [&](const cli::Session& session) { check_config(session, options); };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool);
}
