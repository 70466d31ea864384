// SPDX-License-Identifier: GPL-3.0-or-later
// hazard-map: finds safe places to land on a DEM or terrain.
#include <CLI/CLI.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "app/cli/hazard_input.h"
#include "app/cli/judged_region.h"
#include "app/cli/meeting_options.h"
#include "app/cli/outcomes.h"
#include "app/cli/result_tables.h"
#include "app/cli/tool.h"
#include "app/report/hazard_page.h"
#include "base/core/standard_streams.h"
#include "chain/hazards/sharp_relief.h"
#include "formats/gdal/gdal_loader.h"
#include "store/config/hazard_config.h"
#include "store/files/hazard_file.h"
#include "store/files/hazard_strips.h"
#include "tools.h"

namespace landfall::hazard_map {
namespace {

constexpr const char* kExamples = R"(Examples:
  hazard-map dem.h5 -o hazards.h5 --sites sites.json --table
  hazard-map dem.h5 -o hazards.h5 --report hazards.html
  hazard-map dem.h5 --terrain terrain.h5 -o hazards.h5 --score score.json
  hazard-map terrain.h5 -c preset:jpl-2015 -o hazards.h5
  hazard-map dem.h5 -o hazards.h5 --set limits.slope_deg=15 --require-safe
  hazard-map long.h5 -o hazards.h5 --layers slope,roughness,safe
Exit status 3: --require-safe is given, and no site has a p_touchdown of
sites.min_p or more, or the score misses one of the requirements.
Configuration: --print-schema, man hazard-map, docs/user/hazard-map.md.)";

constexpr const char* kDescription =
    R"(Stands a lander on every place of a DEM or of a gridded terrain, in every yaw, and judges slope and roughness by the lander's limits: each place is safe, a hazard, or unknown. From this it computes the probability that a touchdown is safe, a cost map, and the best landing sites.

If the DEM has the true elevations, they are judged in the same way: the layer outcome shows missed hazards and false alarms, and --score writes their numbers as JSON.)";

struct Options {
  std::string map, terrain, sites, score, report, title, layers_text;
  std::vector<std::string> layers;  ///< none: all
  bool no_truth = false;
  bool table = false;
  bool require_safe = false;
  bool allow_unknown = false;
  MeetingRules rules;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("map", o.map, "DEM to judge (dem.h5), or a gridded terrain (terrain.h5)")->type_name("FILE");
  app.add_option(
         "--terrain", o.terrain,
         "True terrain (terrain.h5): true elevations of bins without a return, in holes that are filled")
      ->type_name("FILE");
  app.add_flag("--no-truth", o.no_truth, "Ignore the true elevations of the DEM");
  app.add_option(
         "--layers", o.layers_text,
         "Write only these of the layers slope, roughness and safe, comma-separated, and judge the map "
         "in strips, without its true elevations and 1-sigmas: for maps that do not fit in memory")
      ->type_name("NAME,...")
      ->each([&o](const std::string& text) { o.layers = CLI::detail::split(text, ','); });
  app.add_option("--sites", o.sites, "Write the landing sites as JSON")->type_name("FILE");
  app.add_option("--score", o.score, "Write the comparison with the truth as JSON")->type_name("FILE");
  app.add_option("--report", o.report, "Write a report: one HTML file with maps, sites and score")
      ->type_name("FILE");
  app.add_option("--title", o.title, "Title of the report; default: the site and the lidar in words")
      ->type_name("TEXT");
  app.add_flag("--table", o.table, "Print places, sites and score; default on a terminal");
  app.add_flag("--require-safe", o.require_safe,
               "Exit with 3 unless a site has a p_touchdown of at least sites.min_p and the score meets "
               "every requirement of the configuration");
  app.add_flag("--allow-unknown", o.allow_unknown,
               "Accept a map on which no place can be judged: all places are unknown, and there is no site");
  cli::bind_meeting_options(app, o.rules);
}

void check_output(const cli::CommonOptions& common, const Options& o) {
  if (common.output_path.empty() && !common.view_path.empty())
    throw UsageError("--view shows the output and needs -o");
  const bool has_output =
      !common.output_path.empty() || !o.sites.empty() || !o.score.empty() || !o.report.empty();
  if (!has_output && !o.require_safe && !common.shows_table(o.table))
    throw UsageError("nothing to write; give -o, --sites, --score, --report or --table");
}

/// Refuses options that need layers which --layers leaves out.
void check_strips(const cli::CommonOptions& common, const Options& o) {
  if (o.layers.empty()) return;
  check_strip_layers(o.layers);
  if (o.allow_unknown) throw UsageError("--allow-unknown is for whole maps, and --layers judges strips");
  if (common.output_path.empty()) throw UsageError("--layers chooses the layers of the output and needs -o");
  for (const auto& [option, value] :
       {std::pair("--terrain", o.terrain), std::pair("--score", o.score), std::pair("--report", o.report)})
    if (!value.empty())
      throw UsageError(std::string(option) + " needs all layers, of which --layers leaves some out");
}

void check(const cli::CommonOptions& common, const Options& o) {
  if (o.map.empty()) throw UsageError("a DEM or terrain to judge is required");
  check_output(common, o);
  if (o.table && common.json_summary) throw UsageError("--table and --json both write to standard output");
  if (o.no_truth && !o.score.empty())
    throw UsageError("--score compares with the truth, which --no-truth ignores");
  if (o.no_truth && !o.terrain.empty())
    throw UsageError("--terrain completes the truth, which --no-truth ignores");
  if (o.sites == "-" || o.score == "-")
    throw UsageError("--sites and --score need a file; --table prints both");
  if (!o.title.empty() && o.report.empty()) throw UsageError("--title needs --report");
  if (o.report == "-") throw UsageError("--report needs a file");
  check_strips(common, o);
}

/// Gives the sites their positions on the map of the site.
void place(cli::Session& session, const std::string& name, HazardMap& map, const std::string& crs_wkt) {
  if (const auto why = no_map_positions(crs_wkt))
    session.warn(name + ": the sites have no map coordinates: " + *why);
  place_on_map(map.sites, crs_wkt);
}

/// Prints the requested tables, and passes on the outcome.
ExitCode conclude(cli::Session& session, const Options& o, const HazardMap& map,
                  const HazardParameters& parameters, bool is_sharp = false) {
  const RequirementVerdicts own = own_verdicts(map, parameters);
  const double tenth_m = parameters.lander.body_radius_m / 5;
  if (const double bin_m = map.safe.spec().resolution_m; map.p_safe && bin_m > tenth_m)
    session.warn(o.map + ": bins of " + number_text(bin_m) +
                 " m are coarser than a tenth of the body's diameter, " + short_number(tenth_m) +
                 " m: p_safe is less sure");
  if (is_sharp)
    session.warn(o.map + ": rocks or steps stand out of the relief: next to them p_safe is less sure");
  if (session.options().shows_table(o.table))
    standard_output() << cli::hazard_table(map) << cli::own_table(own);
  std::optional<double> required;
  if (o.require_safe) required = parameters.sites.min_p;
  return cli::report_hazards(session, o.map, map, own, required);
}

ExitCode run_in_strips(cli::Session& session, const Options& o, const HazardParameters& parameters) {
  if (parameters.z_sigma_m)
    throw UsageError(session.config_name() +
                     ": /z_sigma_m: gives the map 1-sigmas, which --layers leaves out");
  const OutputOptions output = session.output({o.map});
  const auto sites_file = session.side_output("--sites", o.sites, {o.map});
  HazardStripReader reader(o.map);
  if (reader.has_sigma())
    session.warn(o.map + ": --layers leaves out its 1-sigmas: sites count safe places, without p_safe");
  Provenance provenance = session.provenance();
  provenance.options = {{"layers", o.layers}};
  cli::add_meeting_options(provenance.options, o.rules);
  provenance.add_input(reader.kind(), reader.file_id(), reader.chain());
  StripSource source = reader.source();
  source.region =
      cli::read_judged_region(session, {o.map, source.spec, reader.crs_wkt(), true, o.rules}, provenance);
  LandfallFileWriter file(output, "hazards", provenance);
  HazardStripWriter writer(file, source.spec, reader.crs_wkt(), o.layers);
  HazardMap map;
  session.with_file_names(o.map, [&] {
    map = map_strips(
        source, parameters, [&](const PlaceMeasures& strip) { writer.take(strip); }, session.phases());
  });
  if (reader.has_sigma()) map.no_probability = kProbabilityLeftOut;
  place(session, o.map, map, reader.crs_wkt());
  session.phase("write", [&](const ProgressCallback&) {
    if (sites_file) write_text(*sites_file, sites_json(map).dump(2) + "\n");
    writer.finish(map);
    if (sites_file) sites_file->commit();
  });
  return conclude(session, o, map, parameters);
}

ExitCode run(cli::Session& session, const Options& o) {
  check(session.options(), o);
  const HazardParameters parameters = hazard_config(session.config(), session.config_name());
  if (!o.layers.empty()) return run_in_strips(session, o, parameters);
  // The outputs are refused before the map is read, and appear together or not at all.
  const std::vector<std::string> inputs = {o.map, o.terrain};
  std::optional<OutputOptions> output;
  if (!session.options().output_path.empty()) output = session.output(inputs);
  const auto sites_file = session.side_output("--sites", o.sites, inputs);
  const auto score_file = session.side_output("--score", o.score, inputs);
  const auto report_file = session.side_output("--report", o.report, inputs);
  Provenance provenance = session.provenance();
  if (o.no_truth) provenance.options = {{"no_truth", true}};
  cli::add_meeting_options(provenance.options, o.rules);
  HazardSource source;
  HazardInput input;
  session.phase("read", [&](const ProgressCallback&) { source = read_hazard_source(o.map, !o.no_truth); });
  provenance.add_input(source.kind, source.file_id, source.chain);
  cli::warn_of_spacing(session, o.map, source.truth_spacing_m, source.is_imported,
                       {parameters.lander.pad_diameter_m, "farther apart than a pad is wide", "a pad"});
  if (score_file && !source.z_true)
    throw FormatError(o.map + ": has no true elevations (z_true), which --score needs");
  std::optional<BinMask> region =
      cli::read_judged_region(session, {o.map, source.z.spec(), source.crs_wkt, true, o.rules}, provenance);
  input = cli::complete_hazard_input(session, {o.map, o.terrain, o.rules}, source, parameters, provenance);
  input.region = std::move(region);
  input.takes_unknown = o.allow_unknown;
  std::optional<LandfallFileWriter> file;
  if (output) file.emplace(*output, "hazards", provenance);
  HazardMap map;
  session.with_file_names(o.map, [&] { map = map_hazards(input, parameters, session.phases()); });
  if (!map.nothing_to_judge.empty()) session.warn(o.map + ": " + map.nothing_to_judge);
  place(session, o.map, map, source.crs_wkt);
  session.phase("write", [&](const ProgressCallback&) {
    if (sites_file) write_text(*sites_file, sites_json(map).dump(2) + "\n");
    if (score_file) write_text(*score_file, score_json(map.truth->score).dump(2) + "\n");
    if (report_file)
      write_text(*report_file, html_report::hazard_page({input, parameters, map, source.truth_spacing_m},
                                                        provenance, o.title));
    if (file) write_hazards(*file, map, source.crs_wkt);
    if (sites_file) sites_file->commit();
    if (score_file) score_file->commit();
    if (report_file) report_file->commit();
  });
  return conclude(session, o, map, parameters, map.p_safe && has_sharp_relief(input.z, map.region));
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  Options options;
  cli::Tool tool("hazard-map");
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.check = [](const cli::Session& s) { static_cast<void>(hazard_config(s.config(), s.config_name())); };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::hazard_map
