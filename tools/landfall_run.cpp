// SPDX-License-Identifier: GPL-3.0-or-later
// landfall run: the whole chain from one configuration.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <vector>

#include "app/cli/chain.h"
#include "app/cli/chain_record.h"
#include "app/cli/meeting_options.h"
#include "app/cli/tool.h"
#include "app/exports/terrain_output.h"
#include "base/core/standard_streams.h"
#include "base/dictionary/tables/stages.h"
#include "base/output/output_path.h"
#include "base/text/joined.h"
#include "store/config/chain_config.h"
#include "store/config/import_config.h"
#include "store/config/stage_sections.h"
#include "store/files/landfall_file.h"
#include "tools.h"

namespace landfall::landfall_run {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExamples = R"(Examples:
  landfall run -c preset:paper -o paper
  landfall run -c chain.json -o site --set scan.noise.range_sigma_m=0.02
  landfall run -c chain.json --from moon.tif --center 3800,3380 -o moon
  landfall run -c chain.json -o site --require-pass --require-safe
  landfall run -c chain.json -o site --print-commands
Exit status 3: --require-pass is given, and a requirement is missed or cannot
be judged; or --require-safe is given, and no site is safe enough.
Configuration: --print-schema, man landfall-run, docs/user/landfall.md.)";

constexpr const char* kDescription =
    R"(Runs terrain-gen, scan-sim, regrid, dem-eval and hazard-map from one configuration, whose sections terrain, scan, regrid, eval and hazard are those of the tools. The folder of -o gets terrain.h5, scan.h5, dem.h5, eval.h5, metrics.json, report.html, hazards.h5, sites.json and hazards.html, each with the bytes that the single tool writes, and the tables of requirements and landing sites are printed.

A stage of the folder whose inputs have not changed is not run again; one whose inputs have changed is replaced, and a line says why. The folder of another chain, with other names of -c and --from and another configuration, is refused without -O, and so is a file of such a name that this command did not make. After a failure the finished stages remain.)";

struct Options {
  std::string from, center;
  bool require_pass = false;
  bool require_safe = false;
  bool print_commands = false;
  MeetingRules rules;
  bool replaces_terrain = false;               ///< --from, and the configuration has a section terrain
  std::map<std::string, std::string> streams;  ///< JsonSource::streams
};

void bind(CLI::App& app, Options& o) {
  CLI::Option* const from =
      app.add_option("--from", o.from, "Raster to import, in place of the section terrain")
          ->type_name("FILE");
  app.add_option("--center", o.center,
                 "Site centre in the CRS of the raster; default: the middle of the raster")
      ->type_name("X,Y")
      ->needs(from);
  app.add_flag("--require-pass", o.require_pass, "Exit with 3 unless every requirement of dem-eval passes");
  app.add_flag("--require-safe", o.require_safe,
               "Exit with 3 unless a site has a p_touchdown of at least hazard.sites.min_p");
  app.add_flag("--print-commands", o.print_commands,
               "Print the commands of the single tools and run nothing");
  cli::bind_meeting_options(app, o.rules);
}

/// Sections of --set may be presets too, and --from replaces that of the terrain.
void complete(JsonSource& source, Options& o) {
  o.streams = source.streams;
  expand_stage_sections(source);
  if (!o.from.empty()) {
    o.replaces_terrain = source.value.contains("terrain");
    source.value["terrain"] = import_section(o.from, o.center);
  }
  fill_area(source.value, true);
  import_terrain(source,
                 [](const DemBase& dem, const SiteRequest& request) { return fit_site_of(dem, request); });
}

cli::ChainRequest request_of(const cli::Session& session, const Options& o) {
  const fs::path folder = session.options().output_path;
  if (folder.empty()) throw UsageError("-o/--output is required: the folder of the outputs");
  return {folder, o.require_pass, o.require_safe, o.rules};
}

void make_folder(const fs::path& folder) {
  std::error_code failure;
  if (fs::exists(folder) && !fs::is_directory(folder))
    throw UsageError("output " + folder.string() + " exists and is not a folder");
  fs::create_directory(folder, failure);
  if (failure)
    throw UsageError("output " + folder.string() + ": cannot make this folder: " + failure.message());
}

/// The options of this run that its tools take too. Log and progress go to one terminal and one file.
std::vector<std::string> shared_options(const cli::CommonOptions& common) {
  std::vector<std::string> words = {"-t", std::to_string(common.threads), "--compression",
                                    std::to_string(common.compression)};
  if (common.quiet) words.emplace_back("-q");
  if (common.verbose) words.emplace_back("-v");
  if (common.progress) words.emplace_back(*common.progress ? "--progress" : "--no-progress");
  if (common.record_environment) words.emplace_back("--record-environment");
  if (!common.log_path.empty()) words.insert(words.end(), {"--log", common.log_path});
  return words;
}

ToolFunction* function_of(const cli::ChainStage& stage) {
  static const std::map<std::string, ToolFunction*> functions = {{"terrain-gen", terrain_gen::start},
                                                                 {"scan-sim", scan_sim::start},
                                                                 {"regrid", regrid::start},
                                                                 {"dem-eval", dem_eval::start},
                                                                 {"hazard-map", hazard_map::start}};
  return functions.at(stage.tool);
}

/// The result of a stage.
struct StageResult {
  ExitCode code = ExitCode::done;
  bool kept = false;
  std::string table;
};

StageResult run_tool(const cli::Session& session, const cli::ChainStage& stage,
                     const std::vector<std::string>& options, bool keep_same, cli::ChainRecord& record) {
  std::vector<const char*> argv = {stage.tool.c_str()};
  for (const std::string& word : stage.arguments) argv.push_back(word.c_str());
  for (const std::string& word : options) argv.push_back(word.c_str());
  const std::string section =
      std::ranges::find(dictionary::kStages, stage.tool, &dictionary::Stage::tool)->name;
  cli::Invocation invocation{.keep_same = keep_same, .section = session.config_name() + ": /" + section};
  const CapturedOutput text;
  // A single output is known by its file_id.
  const BeforeNaming note(stage.side_outputs.empty() ? std::function<void()>()
                                                     : [&] { record.announce(stage); });
  const int code = function_of(stage)(static_cast<int>(argv.size()), argv.data(), &invocation);
  return {static_cast<ExitCode>(code), invocation.kept, text.text()};
}

/// Runs a stage unless its outputs are those that it would make.
StageResult run_stage(const cli::Session& session, const cli::ChainStage& stage, cli::ChainRecord& record) {
  const auto is_own = [&](const fs::path& path) { return record.is_own(path); };
  const auto is_foreign = [&](const fs::path& path) { return record.is_foreign(path); };
  const bool sides_are_own = std::ranges::all_of(stage.side_outputs, is_own);
  const bool has_foreign =
      record.is_foreign(stage.output) || std::ranges::any_of(stage.side_outputs, is_foreign);
  const bool is_judged = stage.requirement.empty() || record.has_met(stage);
  std::vector<std::string> options = shared_options(session.options());
  if (session.options().overwrite || !has_foreign) options.emplace_back("-O");
  if (!stage.requirement.empty()) options.push_back(stage.requirement);
  const nlohmann::json before = cli::step_of(stage.output);
  const bool existed = fs::exists(stage.output);
  // A stage that ended between its names has no table in the record.
  const bool is_recorded = stage.side_outputs.empty() || !record.is_announced(stage.output);
  StageResult result = run_tool(session, stage, options, sides_are_own && is_judged && is_recorded, record);
  if (result.kept) result.table = record.table(stage);
  const bool is_done = result.code == ExitCode::done || result.code == ExitCode::requirement_missed;
  if (is_done && !result.kept && existed) {
    const std::string reason = cli::replacement_reason(before, cli::step_of(stage.output));
    if (!reason.empty()) session.conclude(stage.output.string() + " replaced: " + reason, true);
  }
  if (is_done && (!result.kept || !record.is_own(stage.output))) {
    std::optional<bool> met;
    if (!stage.requirement.empty()) met = result.code == ExitCode::done;
    record.add(stage, result.table, met);
  }
  return result;
}

/// Whether the tool itself can decide about an existing output: by its file_id.
bool has_file_id(const fs::path& output) {
  try {
    return fs::exists(output) && is_landfall_file(output);
  } catch (const FormatError&) {  // damaged
    return false;
  }
}

/// Refuses, before any work, inputs that a later stage would refuse.
void require_own(const cli::Session& session, const std::vector<cli::ChainStage>& stages,
                 const cli::ChainRecord& record) {
  std::vector<std::string> inputs = session.options().config_names;
  inputs.push_back(session.options().log_path);
  for (const cli::ChainStage& stage : stages) {
    std::vector<fs::path> outputs = stage.side_outputs;
    outputs.push_back(stage.output);
    for (const fs::path& output : outputs) {
      for (const std::string& input : inputs)
        if (!input.empty() && input != "-" && same_file(output, input))
          throw UsageError("output " + output.string() + " is an input of this run; name another folder");
      const bool is_decided_later = output == stage.output && has_file_id(output);
      if (!session.options().overwrite && !is_decided_later && record.is_foreign(output))
        throw UsageError("output " + output.string() +
                         " exists, and landfall run did not make it; use -O to overwrite it");
    }
  }
}

/// Refuses the folder of another chain unless it may be overwritten; otherwise the folder becomes that of
/// this chain, once a stage is made or all are found.
void take_over(cli::Session& session, const Options& o, const fs::path& folder, cli::ChainRecord& record) {
  cli::ChainIdentity mine =
      cli::chain_identity({session.options().config_names, o.from, o.streams}, session.config(), folder);
  const std::optional<cli::ChainIdentity>& known = record.chain();
  const bool has_outputs = !record.outputs().empty();
  if (has_outputs && !known)
    session.conclude(folder.string() +
                         " has no record of its chain, as folders of version 0.2.0; it now belongs to " +
                         shown_names(mine, folder),
                     true);
  if (has_outputs && known && known->names != mine.names && !session.options().overwrite) {
    const std::string differences = cli::differences_text(known->config, mine.config);
    if (!differences.empty())
      throw UsageError("output " + folder.string() + " holds the results of " + shown_names(*known, folder) +
                       "; this chain, " + shown_names(mine, folder) + ", differs in " + differences +
                       "; name another folder, or use -O to replace them");
  }
  record.set_chain(std::move(mine));
}

/// Names the outputs of an earlier run that this chain does not make: they belong to other maps.
void report_leftovers(const cli::Session& session, const std::vector<cli::ChainStage>& stages,
                      const fs::path& folder, const cli::ChainRecord& record) {
  std::vector<std::string> left = record.outputs();
  for (const cli::ChainStage& stage : stages) {
    std::erase(left, stage.output.filename());
    for (const fs::path& side : stage.side_outputs) std::erase(left, side.filename());
  }
  if (!left.empty())
    session.conclude(
        folder.string() + ": " + joined(left) + " remain from an earlier run; this chain makes none", true);
}

ExitCode run(cli::Session& session, const Options& o) {
  const cli::ChainRequest request = request_of(session, o);
  const std::vector<cli::ChainStage> stages = cli::chain_stages(session.config(), request);
  if (o.print_commands) {
    for (const cli::ChainStage& stage : stages) standard_output() << cli::shell_command(stage) << '\n';
    return ExitCode::done;
  }
  if (o.replaces_terrain) session.warn("--from replaces the section terrain of " + session.config_name());
  make_folder(request.folder);
  cli::ChainRecord record(request.folder);
  take_over(session, o, request.folder, record);
  require_own(session, stages, record);
  ExitCode verdict = ExitCode::done;
  nlohmann::json summary = nlohmann::json::object();
  std::string gap;
  for (const cli::ChainStage& stage : stages) {
    const double start_s = session.elapsed_s();
    const StageResult result = run_stage(session, stage, record);
    if (result.code != ExitCode::done && result.code != ExitCode::requirement_missed) {
      session.conclude(stage.output.string() + " was not made; the finished stages remain", true);
      return result.code;
    }
    if (result.code == ExitCode::requirement_missed) verdict = result.code;
    if (result.kept) session.conclude(stage.output.string() + " is up to date");
    summary[stage.tool] = {{"made", !result.kept}, {"wall_s", session.elapsed_s() - start_s}};
    if (result.table.empty() || session.options().json_summary) continue;
    standard_output() << gap << result.table << std::flush;
    gap = "\n";
  }
  record.save();
  report_leftovers(session, stages, request.folder, record);
  session.count("stages", summary);
  return verdict;
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  Options options;
  cli::Tool tool("landfall run");
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.writes_folder = true;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.complete = [&](JsonSource& source) { complete(source, options); };
  tool.check = [&](const cli::Session& session) {
    check_chain_config(session.config(), session.config_name());
  };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::landfall_run
