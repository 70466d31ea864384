// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/result_tables.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/cli/print.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "chain/evaluation/verdict_text.h"

namespace landfall::cli {
namespace {

using Number = std::optional<double>;

std::string centimetres(const Number& metres) { return metres ? print("%.3f", 100 * *metres) : "-"; }

std::string axes_line(const char* name, const std::array<Number, 3>& metres) {
  return print("  %-36s %10s %10s %10s\n", name, centimetres(metres[0]).c_str(),
               centimetres(metres[1]).c_str(), centimetres(metres[2]).c_str());
}

/// Selects one number of each axis.
template <class Axes, class Axis>
std::string axes_line(const char* name, const Axes& axes, Number Axis::*member) {
  return axes_line(name, {axes.x.*member, axes.y.*member, axes.z.*member});
}

std::string accuracy_lines(const AccuracyMetrics& m, const EvaluationLimits& limits) {
  return print("\nOver footprints of %ld x %ld bins, cm:        x          y          z\n", m.footprint_bins,
               m.footprint_bins) +
         axes_line("absolute error, 95th percentile", m.absolute, &AbsoluteMetrics::p95_m) +
         axes_line("absolute error, largest", m.absolute, &AbsoluteMetrics::max_m) +
         axes_line("relative error, 95th percentile", m.relative, &RelativeMetrics::p95_m) +
         axes_line("relative error, largest", m.relative, &RelativeMetrics::max_m) +
         axes_line("relative error, limit",
                   {limits.relative_xy_m, limits.relative_xy_m, limits.relative_z_m});
}

std::string statistics_lines(const StatisticsMetrics& m) {
  return print("\n%-40s          x          y          z\n", "Over bins of the region, cm:") +
         axes_line("mean", m, &ErrorStatistics::mean_m) +
         axes_line("standard deviation", m, &ErrorStatistics::std_m) +
         axes_line("root mean square", m, &ErrorStatistics::rmse_m) +
         axes_line("median", m, &ErrorStatistics::median_m) + axes_line("NMAD", m, &ErrorStatistics::nmad_m) +
         axes_line("LE90", m, &ErrorStatistics::le90_m) +
         print("  %-36s %10s\n", "horizontal: CE90", centimetres(m.horizontal.ce90_m).c_str());
}

std::string region_text(const RegionMetrics& region) {
  if (region.radius_m && (region.center_x_m.value_or(0) != 0 || region.center_y_m.value_or(0) != 0))
    return print(" within %g m of (%g, %g) m", *region.radius_m, *region.center_x_m, *region.center_y_m);
  if (region.radius_m) return print(" within %g m", *region.radius_m);
  if (region.half_width_m) return print(" within %g m along x and y", *region.half_width_m);
  return region.shape == RegionShape::polygon ? " in the polygon" : " of the mask";
}

/// The names, then those of the missed custom requirements.
std::string listed(std::vector<std::string> names, const RequirementVerdicts& own) {
  for (const RequirementVerdict& verdict : own.all)
    if (verdict.pass == false) names.push_back(verdict.requirement.name);
  return joined(names);
}

std::string row(const VerdictText& text) {
  return print("%-19s %-46s %-7s %s\n", text.name.c_str(), text.value.c_str(), text.limit.c_str(),
               text.verdict);
}

double share(std::int64_t part, std::int64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

std::string place_line(const char* name, std::int64_t count, std::int64_t all) {
  return print("%-8s %13s %9.3f %%\n", name, grouped(count).c_str(), 100 * share(count, all));
}

const char* truth_text(Safety truth) {
  return truth == Safety::safe ? "safe" : truth == Safety::hazard ? "hazard" : "unknown";
}

/// Coordinates on the map of the site, if it has any.
std::string map_lines(const std::vector<LandingSite>& sites) {
  std::string heading = "\nsite";
  for (const MapCoordinate& c : kMapCoordinates)
    if (sites.front().map.*c.value)
      heading +=
          print(" %15s", (c.column + std::string(c.units == std::string("m") ? ", m" : ", deg")).c_str());
  if (heading == "\nsite") return "";
  std::string text = heading + "\n";
  int rank = 0;
  for (const LandingSite& site : sites) {
    text += print("%4d", ++rank);
    for (const MapCoordinate& c : kMapCoordinates)
      if (const auto& value = site.map.*c.value)
        text += print(c.units == std::string("m") ? " %15.2f" : " %15.7f", *value);
    text += "\n";
  }
  return text;
}

std::string touchdown_text(const LandingSite& site) {
  return (is_touchdown_capped(site) ? "at least " : "") +
         print("%.4f", static_cast<double>(site.p_touchdown));
}

std::string site_lines(const HazardMap& map) {
  if (map.sites.empty()) return "\nno site: no safe place within reach\n";
  std::string text = "\nsite     x, m     y, m    cost p_touchdown  slope  roughness  to hazard" +
                     std::string(map.truth ? "  truth\n" : "\n") + print("%49s %10s %10s\n", "deg", "m", "m");
  int rank = 0;
  std::vector<std::string> capped;
  for (const LandingSite& site : map.sites) {
    text += print("%4d %8.2f %8.2f %7.4f %11s %6.2f %10.3f", ++rank, site.x_m, site.y_m,
                  static_cast<double>(site.cost),
                  map.p_safe ? print("%.4f", static_cast<double>(site.p_touchdown)).c_str() : "-",
                  site.slope_deg, site.roughness_m);
    text += site.hazard_distance_m ? print(" %10.2f", static_cast<double>(*site.hazard_distance_m))
                                   : print(" %10s", "-");
    text += map.truth ? print("  %s\n", truth_text(site.truth)) : "\n";
    if (is_touchdown_capped(site)) capped.push_back(std::to_string(rank));
  }
  if (!map.p_safe) text += map.no_probability + "\n";
  if (!capped.empty())
    text += "at least so much, since the map carries no larger p_safe: site " + joined(capped) + "\n";
  return text + map_lines(map.sites);
}

std::string rate_line(const char* name, const std::optional<double>& rate, std::int64_t part,
                      std::int64_t whole, const char* of) {
  return print("%-16s", name) + (rate ? print("%8.3f %%", 100 * *rate) : std::string("         -")) + "   " +
         grouped(part) + " of " + grouped(whole) + " " + of + "\n";
}

using VerdictJson = nlohmann::ordered_json;

/// Probabilities near 1 need their last digits.
std::string p_text(const VerdictJson& p) { return print("%.4f", p.get<double>()); }

std::string rate_line(const std::string& name, const VerdictJson& rate) {
  const auto passed = rate.at("passed").get<std::int64_t>();
  const auto draws = rate.at("draws").get<std::int64_t>();
  if (rate.value("judged", draws) == 0)
    return print("%-20s %8s of %-8s not judged\n", name.c_str(), grouped(passed).c_str(),
                 grouped(draws).c_str());
  return print("%-20s %8s of %-8s %-17s %s\n", name.c_str(), grouped(passed).c_str(), grouped(draws).c_str(),
               (p_text(rate.at("wilson_low")) + " .. " + p_text(rate.at("wilson_high"))).c_str(),
               p_text(rate.at("exact_lower_bound")).c_str());
}

std::string rate_lines(const VerdictJson& result) {
  std::string text;
  for (const VerdictJson& rate : result.at("rates")) text += rate_line(rate.at("requirement"), rate);
  if (result.contains("hazard"))
    text += rate_line("chosen_place_safe", result.at("hazard").at("chosen_place_safe"));
  if (!result.contains("landing")) return text;
  const VerdictJson& landing = result.at("landing");
  const VerdictJson& difference = landing.at("difference");
  text += rate_line("safe landing", landing.at("safe")) + rate_line("without a lidar", landing.at("blind"));
  return text + print("difference %+.4f, %+.4f .. %+.4f (Newcombe, 95 %%), McNemar p %.2g\n",
                      difference.at("value").get<double>(), difference.at("low").get<double>(),
                      difference.at("high").get<double>(), landing.at("mcnemar_p").get<double>());
}

}  // namespace

std::string verdict_table(const Metrics& metrics, const EvaluationLimits& limits) {
  // The heading of the last column begins one column earlier, to end at column 80.
  std::string text = print("%-19s %-46s %-5s %s\n", "requirement", "measured", "limit", "verdict");
  for (const VerdictText& requirement : verdict_texts(metrics, limits)) text += row(requirement);
  text += row({"all", "", "", overall_verdict(metrics)});
  text += "\nRegion: " + grouped(metrics.region.bin_count) + " bins" + region_text(metrics.region) + "; " +
          grouped(metrics.coverage.invalid_count) + " invalid in " + grouped(metrics.coverage.hole_count) +
          (metrics.coverage.hole_count == 1 ? " hole\n" : " holes\n");
  if (metrics.assumptions)
    text += "Assumptions: " + joined(assumption_texts(*metrics.assumptions), ",\n             ") + "\n";
  if (metrics.accuracy)
    text += accuracy_lines(*metrics.accuracy, limits) + statistics_lines(metrics.statistics);
  return text;
}

std::string missed_requirements(const Metrics& metrics) {
  std::vector<std::string> names;
  for (const RequirementVerdict& verdict : metrics.requirements.all)
    if (!verdict.pass.value_or(false)) names.push_back(verdict.requirement.name);
  return listed(names, metrics.own_requirements);
}

std::string own_table(const RequirementVerdicts& own) {
  if (own.all.empty()) return "";
  std::string text = "\n" + row({"requirement", "measured", "limit", "verdict"});
  for (const VerdictText& requirement : own_texts(own)) text += row(requirement);
  return text;
}

std::string missed_requirements(const RequirementVerdicts& own) { return listed({}, own); }

std::string score_lines(const HazardScore::Counts& n, const HazardScore::Rates& rates) {
  return "\n" +
         rate_line("missed hazards", rates.missed_hazard_frac, n.safe_hazard, n.safe_hazard + n.hazard_hazard,
                   "true hazards judged safe") +
         rate_line("false alarms", rates.false_alarm_frac, n.hazard_safe, n.hazard_safe + n.safe_safe,
                   "truly safe places judged hazards") +
         print("%-16s%10s   ", "not compared", "") + grouped(n.unknown) +
         " places unknown in the map or the truth\n";
}

std::string hazard_table(const HazardMap& map) {
  const PlaceCounts counts = count_places(map.safe, map.region);
  std::string text = print("%-8s %13s %11s\n", "place", "bins", "share") +
                     place_line("safe", counts.safe, counts.all()) +
                     place_line("hazard", counts.hazard, counts.all()) +
                     place_line("unknown", counts.unknown, counts.all()) + site_lines(map);
  if (map.truth) text += score_lines(map.truth->score.counts, map.truth->score.rates);
  return text;
}

std::string hazard_summary(const HazardMap& map) {
  const PlaceCounts counts = count_places(map.safe, map.region);
  const std::string text = percent_text(share(counts.safe, counts.all())) + " safe, " +
                           percent_text(share(counts.hazard, counts.all())) + " hazard, " +
                           percent_text(share(counts.unknown, counts.all())) + " unknown; ";
  if (map.sites.empty()) return text + "no safe place within reach";
  const LandingSite& best = map.sites.front();
  return text + "best site (" + short_number(best.x_m) + ", " + short_number(best.y_m) + ") m, " +
         (map.p_safe ? "p_touchdown " + touchdown_text(best) : map.no_probability);
}

std::string draws_table(const VerdictJson& verdict) {
  std::string text = print("%-20s %8s    %-8s %-17s %s\n", "requirement", "passed", "draws", "Wilson 95 %",
                           "at least, 95 %");
  if (verdict.contains("pairs")) {
    for (const VerdictJson& pair : verdict.at("pairs"))
      text += "pair " + std::to_string(pair.at("pair").get<int>()) + "\n" + rate_lines(pair);
    text += "all pairs, for these terrains\n";
  }
  text += rate_lines(verdict);
  if (verdict.contains("sprt"))
    text += "sequential test: " + verdict.at("sprt").get<std::string>() + "; " +
            verdict.at("note").get<std::string>() + "\n";
  return text;
}

std::string draws_summary(const VerdictJson& verdict) {
  const VerdictJson& all = verdict.at("rates").back();
  const auto passed = all.at("passed").get<std::int64_t>();
  const auto draws = all.at("draws").get<std::int64_t>();
  std::string text = grouped(passed) + " of " + grouped(draws) + " draws pass all requirements";
  if (all.value("judged", draws) == 0) return text + "; not judged: the footprint has too few bins";
  if (verdict.contains("sprt")) return text + "; sequential test: " + verdict.at("sprt").get<std::string>();
  return text + "; passes with a probability of at " +
         (passed == 0 ? "most " + p_text(all.at("wilson_high")) + " (Wilson, 95 %)"
                      : "least " + p_text(all.at("exact_lower_bound")) + " (95 %)");
}

}  // namespace landfall::cli
