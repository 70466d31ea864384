// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/verdict_table.h"

#include <array>
#include <cstdio>

#include "evaluation/requirement_info.h"

namespace landfall::cli {
namespace {

using Json = nlohmann::ordered_json;

template <class... Values>
std::string print(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

long long integer(const Json& value) { return static_cast<long long>(value.get<std::int64_t>()); }

std::string number(const Json& value) { return value.is_null() ? "-" : print("%.6g", value.get<double>()); }

/// JSON has no infinity, which the distance is where no bin is valid.
std::string value_of(const RequirementInfo& words, const Json& value) {
  const bool is_distance = words.requirement == &RequirementMetrics::hole_distance;
  return value.is_null() && is_distance ? "inf" : number(value);
}

std::string measured(const RequirementInfo& words) {
  const std::string text = words.measured;
  if (words.unit == RequirementUnit::fraction) return text + ", fraction";
  return words.unit == RequirementUnit::bins ? text + ", bins" : text;
}

std::string verdict(const Json& pass) { return pass.is_null() ? "-" : pass.get<bool>() ? "pass" : "FAIL"; }

std::string centimetres(const Json& metres) {
  return metres.is_null() ? "-" : print("%.3f", 100 * metres.get<double>());
}

std::string line(const char* name, const std::array<std::string, 3>& values) {
  return print("  %-36s %10s %10s %10s\n", name, values[0].c_str(), values[1].c_str(), values[2].c_str());
}

/// One value along each axis.
std::array<std::string, 3> axes(const Json& parent, const char* key) {
  return {centimetres(parent.at("x").at(key)), centimetres(parent.at("y").at(key)),
          centimetres(parent.at("z").at(key))};
}

std::string accuracy_lines(const Json& accuracy, const EvaluationLimits& limits) {
  const Json& absolute = accuracy.at("absolute");
  const Json& relative = accuracy.at("relative");
  const long long bins = integer(accuracy.at("footprint_bins"));
  return print("\nOver footprints of %lld x %lld bins, cm:        x          y          z\n", bins, bins) +
         line("absolute error, 95th percentile", axes(absolute, "p95_m")) +
         line("absolute error, largest", axes(absolute, "max_m")) +
         line("relative error, 95th percentile", axes(relative, "p95_m")) +
         line("relative error, largest", axes(relative, "max_m")) +
         line("relative error, limit",
              {centimetres(limits.relative_horizontal_m), centimetres(limits.relative_horizontal_m),
               centimetres(limits.relative_elevation_m)});
}

std::string statistics_lines(const Json& m) {
  return print("\n%-40s          x          y          z\n", "Over bins of the region, cm:") +
         line("mean", axes(m, "mean_m")) + line("standard deviation", axes(m, "std_m")) +
         line("root mean square", axes(m, "rmse_m")) + line("median", axes(m, "median_m")) +
         line("NMAD", axes(m, "nmad_m")) + line("LE90", axes(m, "le90_m")) +
         print("  %-36s %10s\n", "horizontal: CE90", centimetres(m.at("horizontal").at("ce90_m")).c_str());
}

std::string region_text(const Json& region) {
  const auto half_width = region.find("half_width_m");
  if (const Json& radius = region.at("radius_m"); !radius.is_null())
    return print(" within %g m", radius.get<double>());
  if (half_width != region.end() && !half_width->is_null())
    return print(" within %g m along x and y", half_width->get<double>());
  return " of the mask";
}

std::string requirement_lines(const Json& metrics) {
  std::string text =
      print("%-20s %-44s %12s %10s  %s\n", "requirement", "measured as", "value", "limit", "verdict");
  for (const RequirementInfo& words : kRequirementInfo) {
    const Json& r = metrics.at("requirements").at(words.name);
    text += print("%-20s %-44s %12s %10s  %s\n", words.name, measured(words).c_str(),
                  value_of(words, r.at("value")).c_str(), number(r.at("limit")).c_str(),
                  verdict(r.at("pass")).c_str());
  }
  return text + print("%-20s %-44s %12s %10s  %s\n", "all", "", "", "", verdict(metrics.at("pass")).c_str());
}

}  // namespace

std::string verdict_table(const Json& metrics, const EvaluationLimits& limits) {
  const Json& region = metrics.at("region");
  const Json& coverage = metrics.at("coverage");
  std::string text = requirement_lines(metrics) +
                     print("\nRegion: %lld bins%s; %lld invalid in %lld holes\n",
                           integer(region.at("bin_count")), region_text(region).c_str(),
                           integer(coverage.at("invalid_count")), integer(coverage.at("hole_count")));
  const Json& accuracy = metrics.at("accuracy");
  if (!accuracy.at("footprint_bins").is_null())
    text += accuracy_lines(accuracy, limits) + statistics_lines(metrics.at("statistics"));
  return text;
}

std::vector<std::string> missed_requirements(const Json& metrics) {
  std::vector<std::string> names;
  for (const RequirementInfo& words : kRequirementInfo) {
    const Json& pass = metrics.at("requirements").at(words.name).at("pass");
    if (pass.is_null() || !pass.get<bool>()) names.emplace_back(words.name);
  }
  return names;
}

}  // namespace landfall::cli
