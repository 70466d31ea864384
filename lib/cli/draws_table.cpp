// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/draws_table.h"

#include <cstdint>

#include "base/number_text.h"
#include "cli/print.h"

namespace landfall::cli {
namespace {

using VerdictJson = nlohmann::ordered_json;

/// Probabilities near 1 need their last digits.
std::string p_text(const VerdictJson& p) { return print("%.4f", p.get<double>()); }

std::string rate_line(const std::string& name, const VerdictJson& rate) {
  const auto passed = rate.at("passed").get<std::int64_t>();
  const auto draws = rate.at("draws").get<std::int64_t>();
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
  if (verdict.contains("sprt")) return text + "; sequential test: " + verdict.at("sprt").get<std::string>();
  return text + "; passes with a probability of at least " + p_text(all.at("exact_lower_bound")) + " (95 %)";
}

}  // namespace landfall::cli
