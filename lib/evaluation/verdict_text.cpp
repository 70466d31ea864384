// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/verdict_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>

#include "base/number_text.h"

namespace landfall {
namespace {

std::string centimetres(double metres) { return short_number(100 * metres) + " cm"; }

std::string bins(double count) { return short_number(count) + (count == 1 ? " bin" : " bins"); }

/// "87,348 of 785,321, 11.1 %, worst 5.79 cm".
std::string violations(std::int64_t count, std::int64_t all, double worst_m) {
  const double share = all > 0 ? static_cast<double>(count) / static_cast<double>(all) : 0;
  return grouped(count) + " of " + grouped(all) + ", " + percent_text(share) + ", worst " +
         centimetres(worst_m);
}

/// A number of metrics.json with its unit: lengths in cm, fractions in per cent.
std::string measure(const std::string& metric, double value) {
  if (metric.ends_with("_m")) return centimetres(value);
  if (metric.ends_with("_frac")) return percent_text(value);
  if (metric.ends_with("_bins")) return bins(value);
  return short_number(value);
}

const char* verdict(const Requirement& requirement) {
  return !requirement.pass ? "not judged" : *requirement.pass ? "pass" : "FAIL";
}

std::string relative_elevation(const Metrics& m, const EvaluationLimits& /*limits*/) {
  const RelativeMetrics& z = m.accuracy->relative.z;
  return violations(z.violation_count.value_or(0), m.region.bin_count, z.max_m.value_or(0));
}

/// A footprint is judged along x and along y.
std::string relative_horizontal(const Metrics& m, const EvaluationLimits& /*limits*/) {
  const RelativeMetrics& x = m.accuracy->relative.x;
  const RelativeMetrics& y = m.accuracy->relative.y;
  return violations(x.violation_count.value_or(0) + y.violation_count.value_or(0), 2 * m.region.bin_count,
                    std::max(x.max_m.value_or(0), y.max_m.value_or(0)));
}

std::string absolute_horizontal(const Metrics& m, const EvaluationLimits& limits) {
  const HorizontalMetrics& h = m.accuracy->absolute.horizontal;
  return percent_text(h.within_limit_frac.value_or(0)) + " within " +
         centimetres(limits.absolute_horizontal_m) + ", 95th pct " + centimetres(h.p95_m.value_or(0));
}

/// The value of a requirement, which it has, and its limit.
struct Wording {
  std::string_view name;
  std::string (*value)(const Metrics& m, const EvaluationLimits& limits);
  std::string (*limit)(const EvaluationLimits& limits);
};

constexpr std::array kWordings = {
    Wording{"coverage",
            [](const Metrics& m, const EvaluationLimits& /*limits*/) {
              return grouped(m.coverage.invalid_count) + " of " + grouped(m.region.bin_count) +
                     " bins invalid, " + percent_text(m.coverage.invalid_frac);
            },
            [](const EvaluationLimits& l) { return percent_text(l.invalid_frac); }},
    Wording{"hole_size",
            [](const Metrics& m, const EvaluationLimits& /*limits*/) {
              return "largest hole " + bins(static_cast<double>(m.coverage.largest_hole_bins));
            },
            [](const EvaluationLimits& l) { return bins(static_cast<double>(l.hole_bins)); }},
    Wording{"hole_distance",
            [](const Metrics& m, const EvaluationLimits& /*limits*/) {
              return std::isfinite(m.coverage.max_distance_bins)
                         ? "to the nearest valid bin " + bins(m.coverage.max_distance_bins)
                         : "the DEM has no valid bin";
            },
            [](const EvaluationLimits& l) { return bins(l.distance_bins); }},
    Wording{"relative_elevation", relative_elevation,
            [](const EvaluationLimits& l) { return centimetres(l.relative_elevation_m); }},
    Wording{"relative_horizontal", relative_horizontal,
            [](const EvaluationLimits& l) { return centimetres(l.relative_horizontal_m); }},
    Wording{"absolute_horizontal", absolute_horizontal,
            [](const EvaluationLimits& l) { return percent_text(l.absolute_horizontal_frac); }}};

constexpr const Wording* wording_of(std::string_view name) {
  return std::ranges::find(kWordings, name, &Wording::name);
}
static_assert(std::ranges::all_of(kRequirementInfo, [](const RequirementInfo& info) {
  return wording_of(info.name) != kWordings.end();
}));

/// In place of a value.
std::string no_value(const Metrics& m, const Requirement& requirement) {
  if (!m.accuracy) return "no truth to compare with";
  if (requirement.reason) return "footprint of " + square_text(m.accuracy->footprint_bins) + " bins";
  return requirement.pass ? "no footprint to judge" : "no true positions to compare with";
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
  std::string text;
  if (m.requirements.relative_elevation.reason)
    text = "the footprint has fewer than " + square_text(kMinFootprintBins) + " bins";
  if (!m.requirements.absolute_horizontal.pass)
    text += std::string(text.empty() ? "" : ", and ") + "the DEM has no true positions";
  return text;
}

const char* overall_verdict(const Metrics& m) {
  const auto any = [&](std::optional<bool> pass) {
    return std::ranges::any_of(kRequirementInfo, [&](const RequirementInfo& info) {
      return (m.requirements.*info.requirement).pass == pass;
    });
  };
  if (any(false) || !all_pass(m.own_requirements)) return "FAIL";
  return any(std::nullopt) ? "not judged" : "pass";
}

std::vector<VerdictText> own_texts(const OwnVerdicts& verdicts) {
  std::vector<VerdictText> texts;
  for (const OwnVerdict& own : verdicts.all) {
    const OwnRequirement& r = own.requirement;
    texts.push_back({r.name, r.metric + (own.value ? " " + measure(r.metric, *own.value) : ": no value"),
                     (r.at_least ? ">= " : "") + measure(r.metric, r.limit), own.pass ? "pass" : "FAIL"});
  }
  return texts;
}

std::vector<VerdictText> verdict_texts(const Metrics& m, const EvaluationLimits& limits) {
  std::vector<VerdictText> texts;
  for (const RequirementInfo& info : kRequirementInfo) {
    const Requirement& requirement = m.requirements.*info.requirement;
    const Wording& wording = *wording_of(info.name);
    texts.push_back({info.name, requirement.value ? wording.value(m, limits) : no_value(m, requirement),
                     (info.at_least ? ">= " : "") + wording.limit(limits), verdict(requirement)});
  }
  std::ranges::move(own_texts(m.own_requirements), std::back_inserter(texts));
  return texts;
}

}  // namespace landfall
