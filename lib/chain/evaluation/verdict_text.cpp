// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/verdict_text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>

#include "base/text/key_unit.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

std::string centimetres(double metres) { return short_number(100 * metres) + " cm"; }

std::string bins(double count) { return short_number(count) + (count == 1 ? " bin" : " bins"); }

/// A number of metrics.json with the unit of its key: lengths in cm, fractions in per cent.
std::string measure(const std::string& metric, double value) {
  if (metric.ends_with("_m")) return centimetres(value);
  if (metric.ends_with("_frac")) return percent_text(value);
  if (metric.ends_with("_bins")) return bins(value);
  const std::string_view unit = unit_of_key(metric);
  return short_number(value).append(unit.empty() ? "" : " ").append(unit);
}

const char* verdict(const RequirementVerdict& verdict) {
  return !verdict.pass ? "not judged" : *verdict.pass ? "pass" : "FAIL";
}

/// The largest of a list of metrics, separated by spaces.
double largest(const Metrics& m, const std::string& metrics) {
  double found = 0;
  std::istringstream list(metrics);
  for (std::string metric; list >> metric;) found = std::max(found, number_at(m, metric).value_or(0));
  return found;
}

/// The meaning of a word in braces of a dictionary's `text`; `value` is that of the requirement.
std::string meaning(std::string_view word, const dictionary::Requirement& words, double value,
                    const Metrics& m, const EvaluationLimits& limits) {
  const double all = static_cast<double>(m.region.bin_count) *
                     static_cast<double>(std::string_view(words.footprints).size());
  if (word == "value" && words.unit == std::string_view("footprints"))
    return grouped(static_cast<std::int64_t>(value));
  if (word == "value") return measure(words.value, value);
  if (word == "all") return grouped(static_cast<std::int64_t>(all));
  if (word == "share") return percent_text(all > 0 ? value / all : 0);
  if (word == "worst") return centimetres(largest(m, words.worst));
  if (word == "limit") return measure(words.worst_limit, limit_of_key(limits, words.worst_limit).value());
  return grouped(static_cast<std::int64_t>(number_at(m, word).value()));
}

/// The measured value of a requirement in words.
std::string value_text(const dictionary::Requirement& words, double value, const Metrics& m,
                       const EvaluationLimits& limits) {
  if (!std::isfinite(value)) return "the DEM has no valid bin";
  std::string text;
  std::string_view rest = words.text;
  for (std::size_t open = rest.find('{'); open != std::string_view::npos; open = rest.find('{')) {
    const std::size_t close = rest.find('}', open);
    text += rest.substr(0, open);
    text += meaning(rest.substr(open + 1, close - open - 1), words, value, m, limits);
    rest.remove_prefix(close + 1);
  }
  return text.append(rest);
}

/// A requirement without a limit of its own allows no footprint beyond that of the errors.
std::string limit_text(const dictionary::Requirement& words, const EvaluationLimits& limits) {
  const std::string key = *words.limit != '\0' ? words.limit : words.worst_limit;
  return (words.at_least ? ">= " : "") + measure(key, limit_of_key(limits, key).value());
}

/// In place of a value.
std::string no_value(const Metrics& m, const RequirementVerdict& verdict) {
  if (!m.accuracy) return "no truth to compare with";
  if (verdict.reason) return "footprint of " + square_text(m.accuracy->footprint_bins) + " bins";
  return verdict.pass ? "no footprint to judge" : "no true positions to compare with";
}

}  // namespace

std::vector<std::string> assumption_texts(const AssumptionMetrics& a) {
  std::vector<std::string> texts = {"footprint of " + square_text(a.footprint_bins) + " bins"};
  if (a.truth_spacing_m) texts.push_back("truth nodes every " + short_number(*a.truth_spacing_m) + " m");
  if (a.median_returns_per_bin)
    texts.push_back(short_number(*a.median_returns_per_bin) + " returns per bin (median)");
  if (a.single_return_frac)
    texts.push_back(percent_text(*a.single_return_frac) + " of the bins with a single return");
  return texts;
}

std::string missing_text(const Metrics& m) {
  if (!m.accuracy) return "the DEM has no truth";
  const auto any = [&](const auto& is_so) { return std::ranges::any_of(m.requirements.all, is_so); };
  std::string text;
  if (any([](const RequirementVerdict& verdict) { return verdict.reason.has_value(); }))
    text = "the footprint has fewer than " + square_text(kMinFootprintBins) + " bins";
  if (any([](const RequirementVerdict& verdict) { return !verdict.pass && !verdict.reason; }))
    text += std::string(text.empty() ? "" : ", and ") + "the DEM has no true positions";
  return text;
}

const char* overall_verdict(const Metrics& m) {
  if (any_is(m.requirements, false) || !all_pass(m.own_requirements)) return "FAIL";
  return any_is(m.requirements, std::nullopt) ? "not judged" : "pass";
}

std::vector<VerdictText> own_texts(const RequirementVerdicts& verdicts) {
  std::vector<VerdictText> texts;
  for (const RequirementVerdict& own : verdicts.all) {
    const Requirement& r = own.requirement;
    texts.push_back({r.name, r.metric + (own.value ? " " + measure(r.metric, *own.value) : ": no value"),
                     (r.at_least ? ">= " : "") + measure(r.metric, r.limit), verdict(own)});
  }
  return texts;
}

std::vector<VerdictText> verdict_texts(const Metrics& m, const EvaluationLimits& limits) {
  std::vector<VerdictText> texts;
  for (const dictionary::Requirement& words : dictionary::kRequirements) {
    const RequirementVerdict& judged = m.requirements[words.name];
    texts.push_back({words.name,
                     judged.value ? value_text(words, *judged.value, m, limits) : no_value(m, judged),
                     limit_text(words, limits), verdict(judged)});
  }
  std::ranges::move(own_texts(m.own_requirements), std::back_inserter(texts));
  return texts;
}

}  // namespace landfall
