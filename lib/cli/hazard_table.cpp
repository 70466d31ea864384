// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/hazard_table.h"

#include <optional>

#include "base/number_text.h"
#include "cli/print.h"

namespace landfall::cli {
namespace {

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

std::string site_lines(const HazardMap& map) {
  if (map.sites.empty()) return "\nno site: no safe place within reach\n";
  std::string text = "\nsite     x, m     y, m    cost p_touchdown  slope  roughness  to hazard" +
                     std::string(map.truth ? "  truth\n" : "\n") + print("%49s %10s %10s\n", "deg", "m", "m");
  int rank = 0;
  for (const LandingSite& site : map.sites) {
    const std::string p = map.p_safe ? print("%.4f", static_cast<double>(site.p_touchdown)) : "-";
    text += print("%4d %8.2f %8.2f %7.4f %11s %6.2f %10.3f", ++rank, site.x_m, site.y_m,
                  static_cast<double>(site.cost), p.c_str(), site.slope_deg, site.roughness_m);
    text += site.distance_to_hazard_m ? print(" %10.2f", static_cast<double>(*site.distance_to_hazard_m))
                                      : print(" %10s", "-");
    text += map.truth ? print("  %s\n", truth_text(site.truth)) : "\n";
  }
  if (!map.p_safe) text += map.no_probability + "\n";
  return text + map_lines(map.sites);
}

std::string rate_line(const char* name, const std::optional<double>& rate, std::int64_t part,
                      std::int64_t whole, const char* of) {
  return print("%-16s", name) + (rate ? print("%8.3f %%", 100 * *rate) : std::string("         -")) + "   " +
         grouped(part) + " of " + grouped(whole) + " " + of + "\n";
}

}  // namespace

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
         (map.p_safe ? "p_touchdown " + print("%.4f", static_cast<double>(best.p_touchdown))
                     : map.no_probability);
}

}  // namespace landfall::cli
