// SPDX-License-Identifier: GPL-3.0-or-later
// regrid: builds a DEM from the returns of one or more scans.
#include <CLI/CLI.hpp>
#include <optional>
#include <utility>

#include "app/cli/meeting_options.h"
#include "app/cli/outcomes.h"
#include "app/cli/tool.h"
#include "app/runs/default_grid.h"
#include "app/runs/dem_output.h"
#include "base/core/parallel.h"
#include "store/config/uncertainty_config.h"
#include "tools.h"

namespace landfall::regrid {
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

A grid that is not given is that of the defaults; for scans of landfall-import it is their extent with the finest posting that leaves at most 5 % of the bins between the points empty.

--uncertainty adds the one-sigma map of the elevations by error propagation, --corrected the elevations moved along the local slope to the bin centres.)";

struct Options {
  DemSources sources;
  DemRequest layers;
  std::string layers_text;
  std::string truth_at;
  std::string method;
  std::optional<double> range_sigma_m;
  std::vector<std::string> navigation_sigmas;
  std::size_t threads = 0;
  bool reads_no_data = false;                ///< --check
  std::optional<std::string> chosen_grid{};  ///< a sentence about a grid that is not given
};

void bind(CLI::App& app, Options& o) {
  app.add_option("scans", o.sources.scans, "Scans to grid (scan.h5)")->type_name("FILE...");
  app.add_option("--terrain", o.sources.terrain, "True terrain (terrain.h5), for the layer z_true")
      ->type_name("FILE");
  app.add_option("--layers", o.layers_text, "Write only these layers, comma-separated")
      ->type_name("NAME,...")
      ->each([&o](const std::string& text) { o.layers.layers = CLI::detail::split(text, ','); });
  app.add_option("--truth-at", o.truth_at,
                 "Position at which z_true is taken: bin_center or centroid; overrides the configuration")
      ->check(CLI::IsMember({"bin_center", "centroid"}));
  app.add_option("--method", o.method, "Gridding method; overrides the configuration")
      ->check(CLI::IsMember({"bilinear_nearest", "bilinear4", "mean", "min", "max", "median"}));
  cli::bind_meeting_options(app, o.sources.rules, "--other-terrain");
  app.add_flag("--corrected", o.layers.corrected,
               "Also write the elevation moved along the local slope to the bin centre");
  app.add_flag("--uncertainty", o.layers.uncertainty,
               "Also write the 1-sigma map: sigmas of z and of x and y and, with --terrain, the truth at the "
               "bin centre");
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

/// The options that set values of the configuration, so that the provenance in the file is complete.
void set_values(nlohmann::json& config, const Options& o) {
  if (!o.truth_at.empty()) config["truth_at"] = o.truth_at;
  if (o.range_sigma_m) config["uncertainty"]["range_sigma_m"] = *o.range_sigma_m;
  for (const std::string& sigma : o.navigation_sigmas) add_navigation_sigma(config, sigma);
  if (!o.method.empty()) config["method"] = o.method;
}

void complete(JsonSource& source, Options& o) {
  set_values(source.value, o);
  if (o.reads_no_data) return;
  const ThreadLimit limit(o.threads);
  o.chosen_grid = complete_grid(source.value, o.sources, source.name);
}

nlohmann::json content_options(const DemRequest& layers, const MeetingRules& rules) {
  nlohmann::json options;
  cli::add_meeting_options(options, rules);
  if (!layers.layers.empty()) options["layers"] = layers.layers;
  if (layers.corrected) options["corrected"] = true;
  if (layers.uncertainty) options["uncertainty"] = true;
  return options;
}

RegridConfig checked_config(const cli::Session& session, const DemRequest& layers) {
  const RegridConfig config = regrid_config(session.config(), session.config_name());
  if ((layers.uncertainty || layers.corrected) && config.method != Method::bilinear_nearest)
    throw UsageError(session.config_name() + ": /method: " + session.config().at("method").dump() +
                     " with --uncertainty or --corrected, which need \"bilinear_nearest\"");
  return config;
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.sources.scans.empty()) throw UsageError("a scan to grid is required");
  const RegridConfig config = checked_config(session, o.layers);
  std::vector<std::string> inputs = o.sources.scans;
  inputs.push_back(o.sources.terrain);
  Provenance provenance = session.provenance();
  provenance.options = content_options(o.layers, o.sources.rules);
  const std::string& section = session.options().section;
  const std::string& name = section.empty() ? session.config_name() : section;
  const BinnedReturns returns = make_dem(
      config, o.sources, o.layers, {session.output(inputs), std::move(provenance), name, session.phases()});
  cli::report_dem(session, returns, config.grid);
  const bool is_sparse = 2 * returns.empty_bins > static_cast<std::int64_t>(config.grid.size());
  if (o.chosen_grid)
    session.warn(o.sources.scans.front() + ": " + *o.chosen_grid);
  else if (is_sparse)
    if (const auto advice = posting_advice(config.grid, o.sources))
      session.warn(o.sources.scans.front() + ": " + *advice);
  return ExitCode::done;
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  Options options;
  cli::Tool tool("regrid");
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.expand = [&](JsonSource&, const cli::CommonOptions& common) {
    options.threads = common.threads;
    options.reads_no_data = common.check_only;
  };
  tool.complete = [&](JsonSource& source) { complete(source, options); };
  tool.check = [&](const cli::Session& session) {
    static_cast<void>(checked_config(session, options.layers));
  };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::regrid
