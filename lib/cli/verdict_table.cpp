// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/verdict_table.h"

#include <array>
#include <cstdio>
#include <optional>

namespace landfall::cli {
namespace {

struct Row {
  const char* name;
  const char* text;
  const Requirement& requirement;
};

std::array<Row, 6> rows_of(const RequirementMetrics& r) {
  return {{{"coverage", "invalid bins, fraction of the region", r.coverage},
           {"hole_size", "largest hole, bins", r.hole_size},
           {"hole_distance", "farthest invalid bin from a valid one, bins", r.hole_distance},
           {"relative_elevation", "footprints over the limit, z", r.relative_elevation},
           {"relative_horizontal", "footprints over the limit, x and y", r.relative_horizontal},
           {"absolute_horizontal", "footprints within the limit, fraction", r.absolute_horizontal}}};
}

template <class... Values>
std::string print(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string number(const std::optional<double>& value) { return value ? print("%.6g", *value) : "-"; }

std::string verdict(const std::optional<bool>& pass) { return !pass ? "-" : *pass ? "pass" : "FAIL"; }

std::string centimetres(const std::optional<double>& metres) {
  return metres ? print("%.3f", 100 * *metres) : "-";
}

std::string line(const char* name, const std::array<std::string, 3>& values) {
  return print("  %-36s %10s %10s %10s\n", name, values[0].c_str(), values[1].c_str(), values[2].c_str());
}

std::string accuracy_lines(const AccuracyMetrics& m, const EvaluationLimits& limits) {
  const auto& a = m.absolute;
  const auto& r = m.relative;
  return print("\nOver footprints of %lld x %lld bins, cm:        x          y          z\n",
               static_cast<long long>(m.footprint_bins), static_cast<long long>(m.footprint_bins)) +
         line("absolute error, 95th percentile",
              {centimetres(a.x.p95_m), centimetres(a.y.p95_m), centimetres(a.z.p95_m)}) +
         line("absolute error, largest",
              {centimetres(a.x.max_m), centimetres(a.y.max_m), centimetres(a.z.max_m)}) +
         line("relative error, 95th percentile",
              {centimetres(r.x.p95_m), centimetres(r.y.p95_m), centimetres(r.z.p95_m)}) +
         line("relative error, largest",
              {centimetres(r.x.max_m), centimetres(r.y.max_m), centimetres(r.z.max_m)}) +
         line("relative error, limit",
              {centimetres(limits.relative_horizontal_m), centimetres(limits.relative_horizontal_m),
               centimetres(limits.relative_elevation_m)});
}

std::string statistics_lines(const StatisticsMetrics& m) {
  const auto of = [&](std::optional<double> ErrorStatistics::*value) {
    return std::array{centimetres(m.x.*value), centimetres(m.y.*value), centimetres(m.z.*value)};
  };
  return print("\n%-40s          x          y          z\n", "Over bins of the region, cm:") +
         line("mean", of(&ErrorStatistics::mean_m)) +
         line("standard deviation", of(&ErrorStatistics::std_m)) +
         line("root mean square", of(&ErrorStatistics::rmse_m)) +
         line("median", of(&ErrorStatistics::median_m)) + line("NMAD", of(&ErrorStatistics::nmad_m)) +
         line("LE90", of(&ErrorStatistics::le90_m)) +
         print("  %-36s %10s\n", "horizontal: CE90", centimetres(m.horizontal.ce90_m).c_str());
}

}  // namespace

namespace {

std::string region_text(const RegionMetrics& region) {
  if (region.radius_m) return print(" within %g m", *region.radius_m);
  if (region.half_width_m) return print(" within %g m along x and y", *region.half_width_m);
  return " of the mask";
}

}  // namespace

std::string verdict_table(const Metrics& metrics, const EvaluationParameters& parameters) {
  std::string text =
      print("%-20s %-44s %12s %10s  %s\n", "requirement", "measured as", "value", "limit", "verdict");
  for (const Row& row : rows_of(metrics.requirements))
    text += print("%-20s %-44s %12s %10s  %s\n", row.name, row.text, number(row.requirement.value).c_str(),
                  number(row.requirement.limit).c_str(), verdict(row.requirement.pass).c_str());
  text += print("%-20s %-44s %12s %10s  %s\n", "all", "", "", "", verdict(metrics.pass).c_str());
  text += print("\nRegion: %lld bins%s; %lld invalid in %lld holes\n",
                static_cast<long long>(metrics.region.bin_count), region_text(metrics.region).c_str(),
                static_cast<long long>(metrics.coverage.invalid_count),
                static_cast<long long>(metrics.coverage.hole_count));
  if (metrics.accuracy)
    text += accuracy_lines(*metrics.accuracy, parameters.limits) + statistics_lines(metrics.statistics);
  return text;
}

std::vector<std::string> missed_requirements(const Metrics& metrics) {
  std::vector<std::string> names;
  for (const Row& row : rows_of(metrics.requirements))
    if (!row.requirement.pass.value_or(false)) names.emplace_back(row.name);
  return names;
}

}  // namespace landfall::cli
