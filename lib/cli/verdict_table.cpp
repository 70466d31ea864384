// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/verdict_table.h"

#include <array>
#include <optional>
#include <vector>

#include "base/joined.h"
#include "base/number_text.h"
#include "cli/print.h"
#include "evaluation/verdict_text.h"

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
                   {limits.relative_horizontal_m, limits.relative_horizontal_m, limits.relative_elevation_m});
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

/// The names, then those of the own requirements that are missed.
std::string listed(std::vector<std::string> names, const OwnVerdicts& own) {
  for (const OwnVerdict& verdict : own.all)
    if (!verdict.pass) names.push_back(verdict.requirement.name);
  return joined(names);
}

std::string row(const VerdictText& text) {
  return print("%-19s %-46s %-7s %s\n", text.name.c_str(), text.value.c_str(), text.limit.c_str(),
               text.verdict);
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
  if (metrics.accuracy)
    text += accuracy_lines(*metrics.accuracy, limits) + statistics_lines(metrics.statistics);
  return text;
}

std::string missed_requirements(const Metrics& metrics) {
  std::vector<std::string> names;
  for (const RequirementInfo& info : kRequirementInfo)
    if (!(metrics.requirements.*info.requirement).pass.value_or(false)) names.emplace_back(info.name);
  return listed(names, metrics.own_requirements);
}

std::string own_table(const OwnVerdicts& own) {
  if (own.all.empty()) return "";
  std::string text = "\n" + row({"requirement", "measured", "limit", "verdict"});
  for (const VerdictText& requirement : own_texts(own)) text += row(requirement);
  return text;
}

std::string missed_requirements(const OwnVerdicts& own) { return listed({}, own); }

}  // namespace landfall::cli
