// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D452
#include "store/files/draws_verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/dictionary/tables/requirements.h"
#include "chain/draws/pass_rate.h"

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson rate_json(const std::string& name, const PassRate& rate) {
  const ProbabilityInterval interval = wilson(rate);
  return {{"requirement", name},
          {"passed", rate.k},
          {"draws", rate.n},
          {"wilson_low", interval.low},
          {"wilson_high", interval.high},
          {"exact_lower_bound", exact_lower_bound(rate)}};
}

/// The rate of a requirement from the pass_flag() of each draw, or NaN where it is not judged. A draw that is
/// not judged might pass or fail: the interval holds for both (D452).
template <class T>
OrderedJson requirement_rate(const std::string& name, const std::vector<T>& passes) {
  const PassRate rate{std::ranges::count(passes, T{1}), std::ssize(passes)};
  const std::int64_t judged = rate.k + std::ranges::count(passes, T{0});
  OrderedJson json = rate_json(name, rate);
  json["judged"] = judged;
  json["wilson_high"] = wilson({rate.k + rate.n - judged, rate.n}).high;
  return json;
}

/// The share of draws whose chosen place is safe in truth, of a run of draws that judges hazards. A draw
/// without a safe place, or whose place is unknown in truth, counts as not safe.
OrderedJson hazard_json(std::int64_t draws, const std::vector<double>& chosen_safe,
                        const std::vector<double>& site_x_m, const std::vector<double>& missed) {
  const auto sites = std::ranges::count_if(site_x_m, [](double x_m) { return !std::isnan(x_m); });
  double sum = 0;
  std::int64_t known = 0;
  for (const double frac : missed)
    if (!std::isnan(frac)) {
      sum += frac;
      ++known;
    }
  return {
      {"draws_with_site", sites},
      {"missed_hazard_frac_mean",
       known > 0 ? OrderedJson(sum / static_cast<double>(known)) : OrderedJson(nullptr)},
      {"chosen_place_safe", rate_json("chosen_place_safe", {std::ranges::count(chosen_safe, 1.0), draws})}};
}

/// Landings with the lidar and without, in pairs. `is_valid` is false after a sequential test.
OrderedJson landing_json(const DrawTable& table, bool is_valid) {
  const std::vector<double>& with = find_metric(table, kLandingSafe)->values;
  const std::vector<double>& without = find_metric(table, kBlindSafe)->values;
  const PairedCounts pairs = paired_counts(with, without);
  const auto off_terrain = [&](const char* column) {
    return std::ranges::count_if(find_metric(table, column)->values,
                                 [](double slope_deg) { return std::isnan(slope_deg); });
  };
  const auto arm = [](const PassRate& rate) {
    OrderedJson json = rate_json("", rate);
    json.erase("requirement");
    return json;
  };
  const ProbabilityDifference difference = newcombe_difference(pairs);
  OrderedJson json = {
      {"safe", arm(pairs.rate_a())},
      {"blind", arm(pairs.rate_b())},
      {"off_terrain",
       {{"lidar", off_terrain("landing.slope_deg")}, {"blind", off_terrain("blind.slope_deg")}}},
      {"both", pairs.both},
      {"only_lidar", pairs.only_a},
      {"only_blind", pairs.only_b},
      {"neither", pairs.neither},
      {"mcnemar_p", mcnemar_p(pairs)},
      {"difference", {{"value", difference.value}, {"low", difference.low}, {"high", difference.high}}}};
  if (!is_valid) json["note"] = "intervals, p and difference are not valid after stopping";
  return json;
}

/// The rates of all rows.
OrderedJson result_json(const DrawTable& table, bool is_valid) {
  OrderedJson rates = OrderedJson::array();
  for (const dictionary::Requirement& words : dictionary::kRequirements)
    rates.push_back(requirement_rate(words.name, pass_column(table, words.name).values));
  rates.push_back(requirement_rate("all", six_passed(table)));
  const std::vector<OwnColumn> own = own_columns(table);
  for (const OwnColumn& column : own) rates.push_back(requirement_rate(column.name, column.passes->values));
  if (!own.empty()) rates.push_back(requirement_rate("all_and_own", table.pass));
  OrderedJson result = {{"rates", std::move(rates)}};
  const DrawColumn* const chosen_safe = find_metric(table, "site.true_safe");
  const DrawColumn* const site_x = find_metric(table, "site.x_m");
  const DrawColumn* const missed = find_metric(table, "score.missed_hazard_frac");
  if (chosen_safe != nullptr && site_x != nullptr && missed != nullptr)
    result["hazard"] = hazard_json(table.size(), chosen_safe->values, site_x->values, missed->values);
  if (find_metric(table, kLandingSafe) != nullptr) result["landing"] = landing_json(table, is_valid);
  return result;
}

/// The rows begin .. end - 1.
DrawTable rows_of_pair(const DrawTable& table, std::ptrdiff_t begin, std::ptrdiff_t end) {
  const auto cut = [&](const auto& values) {
    return std::decay_t<decltype(values)>(values.begin() + begin, values.begin() + end);
  };
  DrawTable result = {table.first + begin, cut(table.seeds), cut(table.draws),
                      table.varied,        table.metrics,    cut(table.pass)};
  for (auto* const columns : {&result.varied, &result.metrics})
    for (DrawColumn& column : *columns) column.values = cut(column.values);
  return result;
}

}  // namespace

OrderedJson verdict_json(const DrawTable& table, const std::optional<SprtState>& sprt) {
  OrderedJson verdict = {{"format", "landfall.draws_verdict"}, {"version", 1}, {"confidence", 0.95}};
  if (sprt) {
    constexpr std::array kStates = {"running", "accepted", "rejected"};
    verdict["sprt"] = kStates.at(static_cast<std::size_t>(*sprt));
    verdict["note"] = "intervals are not valid after stopping";
  }
  if (!table.varied.empty() && table.varied.front().name == kPairColumn) {
    verdict["note"] = "for these terrains; another terrain is not part of the probability";
    const std::vector<double>& pairs = table.varied.front().values;
    for (auto begin = pairs.begin(); begin != pairs.end();) {  // the rows of a pair follow each other
      const auto end = std::find_if(begin + 1, pairs.end(), [&](double pair) { return pair != *begin; });
      OrderedJson result = {{"pair", *begin}};
      result.update(result_json(rows_of_pair(table, begin - pairs.begin(), end - pairs.begin()), !sprt));
      verdict["pairs"].push_back(std::move(result));
      begin = end;
    }
  }
  verdict.update(result_json(table, !sprt));
  return verdict;
}

}  // namespace landfall
