// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/plan_table.h"

#include <array>
#include <cstdio>

namespace landfall::cli {
namespace {

using Json = nlohmann::ordered_json;

template <class... Values>
std::string print(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string time_line(const char* name, const Json& pulses) {
  return print("  %-34s %10lld %12.4f %8.2f %%\n", name,
               static_cast<long long>(pulses.at("pulse_count").get<std::int64_t>()),
               pulses.at("time_s").get<double>(), 100 * pulses.at("frac").get<double>());
}

std::string spread_line(const char* name, const Json& spread) {
  const auto value = [&](const char* key) {
    return static_cast<long long>(spread.at(key).get<std::int64_t>());
  };
  return print("  %-20s %8.3f %8lld %8lld %8lld %8lld %8lld\n", name, spread.at("mean").get<double>(),
               value("min"), value("p05"), value("median"), value("p95"), value("max"));
}

long long integer(const Json& value) { return static_cast<long long>(value.get<std::int64_t>()); }

}  // namespace

std::string plan_table(const Json& plan) {
  const Json& time = plan.at("time");
  const Json& region = plan.at("region");
  const Json& returns = plan.at("returns");
  const Json& coverage = plan.at("coverage");
  std::string text = "Time                                     pulses     seconds     share\n";
  text += time_line("image in the region", time.at("in_region")) +
          time_line("image partly in the region", time.at("partly_in_region")) +
          time_line("image outside the region", time.at("off_region")) +
          time_line("blanked", time.at("blanked")) + time_line("all", time.at("total"));
  text += print("\nRegion: %lld bins of %g m within %g m, on flat ground\n", integer(region.at("bin_count")),
                region.at("resolution_m").get<double>(), region.at("radius_m").get<double>());
  text += print("  uncovered: %lld bins, %.4f %%, in %lld holes; the largest has %lld bins\n",
                integer(coverage.at("uncovered_count")), 100 * coverage.at("uncovered_frac").get<double>(),
                integer(coverage.at("hole_count")), integer(coverage.at("largest_hole_bins")));
  text += print("  returns: %lld, of which %lld in the region and %lld the first of their bin\n",
                integer(returns.at("count")), integer(returns.at("in_region")),
                integer(returns.at("first_in_bin")));
  text += print("  seen by more than one image: %.2f %% of the bins\n",
                100 * plan.at("images_per_bin").at("overlap_frac").get<double>());
  text += print("\n  %-20s %8s %8s %8s %8s %8s %8s\n", "Per bin of the region", "mean", "least", "5 %",
                "median", "95 %", "most");
  return text + spread_line("returns", plan.at("returns_per_bin")) +
         spread_line("images", plan.at("images_per_bin"));
}

}  // namespace landfall::cli
