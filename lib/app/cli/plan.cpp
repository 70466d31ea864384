// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/plan.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "app/cli/print.h"
#include "app/runs/scene.h"
#include "base/core/standard_streams.h"
#include "base/text/parameter_check.h"
#include "chain/evaluation/parameters.h"
#include "store/config/scan_config.h"
#include "store/files/field_json.h"
#include "store/files/table_reader.h"

namespace landfall::cli {
namespace {

std::string time_line(const char* name, const PlanMetrics::Pulses& pulses) {
  return print("  %-34s %10ld %12.4f %8.2f %%\n", name, pulses.pulse_count, pulses.time_s, 100 * pulses.frac);
}

std::string spread_line(const char* name, const BinSpread& s) {
  return print("  %-20s %8.3f %8ld %8ld %8ld %8ld %8ld\n", name, s.mean, s.min, s.p05, s.median, s.p95,
               s.max);
}

std::string posting_line(const PlanMetrics::Posting& p) {
  const std::string text = print("  posting: %.4g returns per m2; ", p.returns_per_m2);
  if (!p.posting_m) return text + print("no posting fills %g %% of its bins\n", 100 * p.wanted_frac);
  return text + print("%g m is the finest that fills %g %% of its bins (%.2f %%)\n", *p.posting_m,
                      100 * p.wanted_frac, 100 * *p.filled_frac);
}

/// A posting at which dem-eval does not judge the default footprint needs a larger one, or another scan.
void warn_of_posting(Session& session, const PlanMetrics& plan) {
  if (!plan.posting || !plan.posting->posting_m) return;
  if (const auto why = why_not_judged(EvaluationParameters{}, *plan.posting->posting_m))
    session.warn("the proposed posting is too coarse for dem-eval: " + *why);
}

/// The smallest grid of bins centred on the origin that contains the region.
GridSpec plan_grid(const PlanOptions& o) {
  require_positive({"", "--plan-radius"}, o.radius_m);
  require_positive({"", "--plan-resolution"}, o.resolution_m);
  const double bins = std::max(1.0, std::ceil(o.radius_m / o.resolution_m - 1e-9));
  return GridSpec::centered(bins * o.resolution_m, o.resolution_m, "--plan-radius, --plan-resolution");
}

/// A plan is of the configured path, from which the true one departs.
nlohmann::json planned_scan(Session& session) {
  nlohmann::json config = session.config();
  const nlohmann::json none = {0, 0, 0};
  for (auto& [key, value] : config.at("trajectory_dispersion").items()) {
    if (value != none) session.warn("/trajectory_dispersion/" + key + ": has no effect on a plan");
    value = none;
  }
  return config;
}

}  // namespace

void bind_plan(CLI::App& app, PlanOptions& o) {
  CLI::Option* const plan = app.add_flag("--plan", o.requested,
                                         "Print the coverage of flat terrain (z = 0) and the time budget of "
                                         "the scan, without tracing; -o writes the "
                                         "coverage as layers");
  app.add_option("--plan-radius", o.radius_m, "Radius of the region of a plan, metres")
      ->type_name("M")
      ->needs(plan)
      ->capture_default_str();
  app.add_option("--plan-resolution", o.resolution_m, "Bin edge of a plan, metres")
      ->type_name("M")
      ->needs(plan)
      ->capture_default_str();
  app.add_option("--plan-filled", o.filled_frac,
                 "Share of bins with a return that the posting proposed by a plan has at least: the finest "
                 "multiple of the bin edge that reaches it")
      ->type_name("FRAC")
      ->needs(plan)
      ->capture_default_str();
}

ExitCode run_plan(Session& session, const PlanOptions& o, std::int64_t batch_points) {
  Provenance provenance = session.provenance();
  provenance.options = {{"plan", {{"radius_m", o.radius_m}, {"resolution_m", o.resolution_m}}}};
  if (o.filled_frac != PlanOptions{}.filled_frac) provenance.options["plan"]["filled_frac"] = o.filled_frac;
  require_fraction({"", "--plan-filled"}, o.filled_frac);
  Grid<std::int8_t> region = circular_region(plan_grid(o), o.radius_m);
  ScanModel model =
      scan_model(planned_scan(session), session.config_name(), recording_table_loader(provenance));
  std::optional<LandfallFileWriter> file;
  if (!session.options().output_path.empty()) file.emplace(session.output(), "plan", provenance);
  const double pulse_rate_hz = model.pulse_rate_hz;
  const Scene scene = open_scene({});
  const Simulation simulation(std::move(model), scene.engine.get(), scene.surface.get());
  std::optional<ScanPlan> plan;
  session.phase("plan", [&](const ProgressCallback& progress) {
    plan = plan_scan(simulation, std::move(region), batch_points, progress);
  });
  PlanSummary summary;
  session.phase("coverage", [&](const ProgressCallback&) {
    summary = summarize_plan(*plan, {o.radius_m, o.filled_frac}, pulse_rate_hz);
    if (file) write_plan(*file, *plan, summary);
  });
  session.count("plan", fields_json(summary.metrics));
  if (!session.options().json_summary) standard_output() << plan_table(summary.metrics);
  warn_of_posting(session, summary.metrics);
  return ExitCode::done;
}

std::string plan_table(const PlanMetrics& plan) {
  const CoverageMetrics& coverage = plan.coverage;
  std::string text = "Time                                     pulses     seconds     share\n";
  text += time_line("frame in the region", plan.time.in_region) +
          time_line("frame partly in the region", plan.time.partly_in_region) +
          time_line("frame outside the region", plan.time.off_region) +
          time_line("blanked", plan.time.blanked) + time_line("all", plan.time.total);
  text += print("\nRegion: %ld bins of %g m within %g m, on flat terrain\n", plan.region.bin_count,
                plan.region.resolution_m, plan.region.radius_m);
  text += print("  uncovered: %ld bins, %.4f %%, in %ld %s; the largest has %ld bins\n",
                coverage.invalid_count, 100 * coverage.invalid_frac, coverage.hole_count,
                coverage.hole_count == 1 ? "hole" : "holes", coverage.largest_hole_bins);
  text += print("  returns: %ld, %ld in the region, %ld the first of their bin\n", plan.returns.count,
                plan.returns.in_region, plan.returns.first_in_bin);
  text +=
      print("  seen by more than one frame: %.2f %% of the bins\n", 100 * plan.frames_per_bin.above_one_frac);
  if (plan.posting) text += posting_line(*plan.posting);
  text += print("\n  %-20s %8s %8s %8s %8s %8s %8s\n", "Per bin of the region", "mean", "min", "5 %",
                "median", "95 %", "max");
  return text + spread_line("returns", plan.returns_per_bin) + spread_line("frames", plan.frames_per_bin);
}

}  // namespace landfall::cli
