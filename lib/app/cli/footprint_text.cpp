// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/footprint_text.h"

#include "app/cli/comparison_text.h"
#include "app/cli/print.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "base/text/shown_text.h"

namespace landfall::cli {
namespace {

using FootprintJson = nlohmann::ordered_json;

std::string short_text(const FootprintJson& value, double factor = 1) {
  return value.is_number() ? short_number(factor * value.get<double>()) : "-";
}

std::string verdict_lines(const FootprintJson& verdicts) {
  std::string text = print("%-20s %10s %10s\n", "requirement", "here", "limit");
  for (const FootprintJson& verdict : verdicts) {
    const std::string name = verdict["requirement"].get<std::string>();
    const bool is_length = !name.starts_with("hole");
    const auto shown = [&](const FootprintJson& value) {
      return short_text(value, is_length ? 100 : 1) + (is_length ? " cm  " : " bins");
    };
    text += print("%-20s %10s %10s %s\n", name.c_str(), shown(verdict["value"]).c_str(),
                  shown(verdict["limit"]).c_str(),
                  verdict["pass"].is_null()     ? "not judged"
                  : verdict["pass"].get<bool>() ? "pass"
                                                : "FAIL");
  }
  return text;
}

/// "121 bins, 120 with an elevation; 3 returns in a bin, ...": what is known.
std::string bins_line(const FootprintJson& bins) {
  std::string text =
      short_text(bins["bins"]) + " bins, " + short_text(bins["with_elevation"]) + " with an elevation";
  if (bins.contains("median_returns_per_bin"))
    text += "; medians: " + short_text(bins["median_returns_per_bin"]) +
            " returns in a bin, which scatter by " + short_text(bins["median_spread_m"], 100) +
            " cm, slope " + short_text(bins["median_slope_deg"]) + " deg (steepest " +
            short_text(bins["steepest_slope_deg"]) + " deg)";
  if (bins.contains("return_count"))
    text += "; " + short_text(bins["return_count"]) + " returns of the scan, range noise " +
            short_text(bins["range_noise_m"], 100) + " cm, mean range error " +
            short_text(bins["range_error_mean_m"], 100) + " cm";
  return text + "\n";
}

std::string worst_lines(const FootprintJson& worst) {
  std::string text =
      "\nworst bins\n" + print("%9s %9s %9s %9s %9s %9s %12s %10s\n", "x, m", "y, m", "e_x, cm", "e_y, cm",
                               "e_z, cm", "returns", "scatter, cm", "slope, deg");
  for (const FootprintJson& bin : worst)
    text += print("%9s %9s %9s %9s %9s %9s %12s %10s\n", short_text(bin["x_m"]).c_str(),
                  short_text(bin["y_m"]).c_str(), short_text(bin["e_x_m"], 100).c_str(),
                  short_text(bin["e_y_m"], 100).c_str(), short_text(bin["e_z_m"], 100).c_str(),
                  short_text(bin.value("returns", FootprintJson())).c_str(),
                  short_text(bin.value("spread_m", FootprintJson()), 100).c_str(),
                  short_text(bin.value("slope_deg", FootprintJson())).c_str());
  return worst.empty() ? "" : text;
}

std::string rule_lines(const FootprintJson& rules) {
  std::string text = "\nrules of this requirement (docs/user/symptoms.md)\n";
  for (const FootprintJson& rule : rules) {
    const bool at_least = rule.contains("at_least");
    text += print("  %-15s %-5s %8s  at %-5s %-4s  ", rule["cause"].get<std::string>().c_str(),
                  rule["holds"].get<bool>() ? "holds" : "", short_text(rule["value"]).c_str(),
                  at_least ? "least" : "most", short_text(rule[at_least ? "at_least" : "at_most"]).c_str()) +
            rule["measure"].get<std::string>() + "\n";
  }
  return text;
}

std::string cause_lines(const FootprintJson& footprint) {
  const FootprintJson& cause = footprint["cause"];
  if (cause.is_null())
    return footprint["judged"].get<bool>() ? "\nthe footprint passes\n"
                                           : "\nthe bin is outside the judged region\n";
  const std::string missing = joined(footprint["missing"], " and ", [](const FootprintJson& option) {
    return option.get<std::string>() + " FILE";
  });
  return "\nlikely cause of " + cause["requirement"].get<std::string>() + ": " +
         cause["sentence"].get<std::string>() + "\n" + rule_lines(cause["rules"]) +
         (missing.empty() ? "" : "without " + missing + ", rules that need more have no value\n");
}

}  // namespace

std::string footprint_text(const FootprintJson& footprint) {
  const std::string edge = short_text(footprint["footprint_bins"]);
  std::string text = footprint["file"].get<std::string>() + ": the footprint at x " +
                     print("%.10g", footprint["x_m"].get<double>()) + " m, y " +
                     print("%.10g", footprint["y_m"].get<double>()) + " m (" + edge + " x " + edge +
                     " bins of " + print("%g", footprint["resolution_m"].get<double>()) + " m)\n";
  for (const std::string& place : place_lines(footprint)) text += "  " + place + "\n";
  text += "\n" + verdict_lines(footprint["verdicts"]) + bins_line(footprint["bins"]) +
          worst_lines(footprint["worst_bins"]) + cause_lines(footprint);
  return shown_lines(text);
}

}  // namespace landfall::cli
