// SPDX-License-Identifier: GPL-3.0-or-later
// A message quotes at most 60 bytes of an input, 40 of a file, because a CSV cell may have a gigabyte.
// Paths are printed in full.
#include "app/cli/outcomes.h"

#include <algorithm>
#include <cmath>

#include "app/cli/result_tables.h"
#include "base/text/number_text.h"
#include "chain/evaluation/verdict_text.h"
#include "store/files/hazard_file.h"

namespace landfall::cli {
namespace {

/// The fraction of rays, or of the region's width, from which on a user should know.
constexpr double kNotable = 0.01;

}  // namespace

void report_terrain(Session& session, const TerrainContent& terrain) {
  std::string said;
  const auto say = [&](std::size_t count, const char* what) {
    said += (said.empty() ? "" : ", ") + grouped(static_cast<std::int64_t>(count)) + " " + what;
  };
  if (terrain.nodes) {
    session.count("node_count", terrain.nodes->nodes);
    session.count("hole_node_count", terrain.nodes->holes);
    say(static_cast<std::size_t>(terrain.nodes->nodes), "nodes");
    if (terrain.nodes->holes > 0) say(static_cast<std::size_t>(terrain.nodes->holes), "holes");
  }
  if (terrain.features_of) {
    std::int64_t features = 0;
    for (const auto& [kind, count] : *terrain.features_of) features += count;
    session.count("feature_count", features);
    session.count("feature_count_by_kind", *terrain.features_of);
    say(static_cast<std::size_t>(features), "features");
  }
  if (terrain.mesh) {
    session.count("vertex_count", terrain.mesh->mesh.vertices.size());
    session.count("triangle_count", terrain.mesh->mesh.triangles.size());
    session.count("welded_vertex_count", terrain.mesh->welded_vertex_count);
    session.count("unreferenced_vertex_count", terrain.mesh->unreferenced_vertex_count);
    session.count("degenerate_facet_count", terrain.mesh->degenerate_facet_count);
    say(terrain.mesh->mesh.vertices.size(), "vertices");
    say(terrain.mesh->mesh.triangles.size(), "triangles");
  }
  if (!said.empty()) session.conclude(said);
  for (const std::string& warning : terrain.warnings) session.warn(warning);
}

void report_draw_device(Session& session, const DeviceUse& use) {
  if (!use.device().empty()) {
    session.count("device", use.device());
    session.count("device_draw_count", use.draws());
  }
  if (const auto failure = use.failure()) session.warn(*failure + "; the CPU made the draws instead");
}

void report_scan(Session& session, const Simulation& simulation, const ScanWriter& writer) {
  session.count("pulse_count", simulation.pulse_count());
  session.count("ray_count", simulation.ray_count());
  session.count("real_time_factor", simulation.duration_s() / session.elapsed_s());
  for (const PointStatusInfo& info : kPointStatuses)
    if (info.is_counted(simulation.columns().intensity))
      session.count(info.count_name, writer.count(info.status));
  const std::int64_t misses = writer.count(PointStatus::miss);
  const std::int64_t returns = writer.count(PointStatus::returned) + writer.count(PointStatus::false_return);
  const std::int64_t undetected = writer.count(PointStatus::undetected);
  const std::int64_t aimed =
      std::max<std::int64_t>(1, returns + misses + undetected + writer.count(PointStatus::dropout));
  const double missed = static_cast<double>(misses) / static_cast<double>(aimed);
  session.conclude(grouped(simulation.ray_count()) + " rays: " + grouped(returns) + " returns, " +
                   percent_text(missed) + " missed the terrain" +
                   (undetected > 0 ? ", " + grouped(undetected) + " echoes were too weak" : ""));
  if (missed > kNotable)
    session.warn(percent_text(missed) + " of the rays missed the terrain; enlarge it, or narrow the scan");
}

void report_dem(Session& session, const BinnedReturns& returns, const GridSpec& grid) {
  session.count("inside_count", returns.inside_count);
  session.count("outside_count", returns.outside_count);
  session.count("returns_used", returns.returns_used);
  const std::string of_pixels =
      returns.returns_used == "one" ? "" : " (" + returns.returns_used + " of each pixel)";
  session.conclude(grouped(returns.inside_count) + " returns in the map" + of_pixels + ", " +
                   grouped(returns.outside_count) + " outside it; " + grouped(returns.empty_bins) + " of " +
                   grouped(static_cast<std::int64_t>(grid.size())) + " bins are empty");
  for (const std::string& warning : returns.warnings) session.warn(warning);
}

void warn_of_spacing(Session& session, const std::string& dem, std::optional<double> spacing_m,
                     bool is_imported, const SpacingLimit& limit) {
  if (!spacing_m || is_imported || *spacing_m <= limit.spacing_m * (1 + 1e-9)) return;
  session.warn(dem + ": the truth has nodes every " + short_number(*spacing_m) + " m, " + limit.excess +
               " (" + short_number(limit.spacing_m) + " m): it lacks what " + limit.object +
               " would meet; make the terrain finer (grid.resolution_m)");
}

void warn_of_assumptions(Session& session, const std::string& dem, const Metrics& metrics,
                         const EvaluationParameters& parameters, double resolution_m, bool is_imported) {
  if (const auto why = why_not_judged(parameters, resolution_m); why && metrics.accuracy)
    session.warn(dem + ": " + *why);
  warn_of_spacing(session, dem, metrics.assumptions->truth_spacing_m, is_imported,
                  {parameters.footprint_m / 5, "more than a fifth of the footprint", "a lander"});
}

ExitCode report_evaluation(Session& session, const std::string& dem, const Evaluation& evaluation,
                           const BinBox& scanned, bool require_pass) {
  const BinBox region = set_box(evaluation.region);
  const std::int64_t beyond =
      std::max({scanned.first.row - region.first.row, scanned.first.col - region.first.col,
                region.last.row - scanned.last.row, region.last.col - scanned.last.col});
  const std::int64_t width =
      std::max(region.last.row - region.first.row, region.last.col - region.first.col) + 1;
  const bool is_empty = scanned.last.row < scanned.first.row;  // the coverage says so
  if (!is_empty && static_cast<double>(beyond) > kNotable * static_cast<double>(width))
    session.warn(dem + ": the judged region reaches " +
                 short_number(static_cast<double>(beyond) * evaluation.region.spec().resolution_m) +
                 " m beyond the scanned area; reduce it (region_radius_m, or region.half_width_m of a "
                 "square), or scan more");
  const Metrics& metrics = evaluation.metrics;
  const std::string missed = missed_requirements(metrics);
  const bool refused = require_pass && !metrics.pass.value_or(false);
  session.conclude(refused ? dem + ": missed or not judged: " + missed
                           : dem + ": " + overall_verdict(metrics) + (missed.empty() ? "" : ": " + missed),
                   refused);
  return refused ? ExitCode::requirement_missed : ExitCode::done;
}

ExitCode report_hazards(Session& session, const std::string& name, const HazardMap& map,
                        const RequirementVerdicts& own, std::optional<double> min_p) {
  const PlaceCounts counts = count_places(map.safe, map.region);
  session.count("places", {{"safe", counts.safe}, {"hazard", counts.hazard}, {"unknown", counts.unknown}});
  session.count("sites", sites_json(map)["sites"]);
  if (map.truth) session.count("score", score_json(map.truth->score));
  if (map.truth && map.truth->score.counts.unknown == counts.all())
    session.warn(name +
                 ": no place is compared with the truth, because each is unknown in the map or on the "
                 "true terrain");
  if (min_p && !map.p_safe && !map.sites.empty())
    session.warn(name + ": --require-safe: " + map.no_probability +
                 "; p_touchdown counts safe places as certain");
  const bool cannot_tell = min_p && map.p_safe && static_cast<double>(map.p_cap) < *min_p;
  const auto is_enough = [&](const LandingSite& site) { return site.p_touchdown >= *min_p; };
  const bool lacks_site = min_p && std::ranges::none_of(map.sites, is_enough);
  const bool refused = lacks_site || (min_p && !all_pass(own));
  std::string text = name + ": ";
  if (cannot_tell)
    text += "this map carries no p_safe above " +
            number_text(std::floor(1e4 * static_cast<double>(map.p_cap)) / 1e4) + ", and sites.min_p is " +
            number_text(*min_p) + " (smaller bins carry more): ";
  else if (lacks_site)
    text += "no site has a p_touchdown of " + number_text(*min_p) + ": ";
  if (!all_pass(own)) text += "missed: " + missed_requirements(own) + "; ";
  session.conclude(text + hazard_summary(map), refused);
  return refused ? ExitCode::requirement_missed : ExitCode::done;
}

}  // namespace landfall::cli
