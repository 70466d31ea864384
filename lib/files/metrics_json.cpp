// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/metrics_json.h"

#include <cmath>
#include <optional>

namespace landfall {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }
Json verdict(const std::optional<bool>& pass) { return pass ? Json(*pass) : Json(nullptr); }

Json coverage_json(const CoverageMetrics& m) {
  return {{"invalid_count", m.invalid_count},
          {"invalid_frac", number(m.invalid_frac)},
          {"hole_count", m.hole_count},
          {"largest_hole_bins", m.largest_hole_bins},
          {"holes_over_limit", m.holes_over_limit},
          {"max_distance_bins", number(m.max_distance_bins)},
          {"distance_over_limit_count", m.distance_over_limit_count},
          {"hole_size_histogram",
           {{"size_bins", m.hole_size_histogram.size_bins}, {"count", m.hole_size_histogram.count}}}};
}

Json absolute_json(const AbsoluteMetrics& m) {
  return {{"p95_m", number(m.p95_m)}, {"mean_m", number(m.mean_m)}, {"max_m", number(m.max_m)}};
}

Json relative_json(const RelativeMetrics& m, bool known) {
  return {{"p95_m", number(m.p95_m)},
          {"max_m", number(m.max_m)},
          {"violation_count", known ? Json(m.violation_count) : Json(nullptr)}};
}

Json count_json(const std::optional<std::int64_t>& count) { return count ? Json(*count) : Json(nullptr); }

Json statistics_json(const ErrorStatistics& m) {
  return {{"count", count_json(m.count)}, {"mean_m", number(m.mean_m)},     {"std_m", number(m.std_m)},
          {"rmse_m", number(m.rmse_m)},   {"median_m", number(m.median_m)}, {"nmad_m", number(m.nmad_m)},
          {"le90_m", number(m.le90_m)},   {"p95_m", number(m.p95_m)}};
}

Json statistics_json(const StatisticsMetrics& m) {
  Json result = {{"valid_frac", number(m.valid_frac)},
                 {"x", statistics_json(m.x)},
                 {"y", statistics_json(m.y)},
                 {"z", statistics_json(m.z)}};
  if (m.z_corrected) result["z_corrected"] = statistics_json(*m.z_corrected);
  result["horizontal"] = {{"count", count_json(m.horizontal.count)},
                          {"ce90_m", number(m.horizontal.ce90_m)},
                          {"rmse_m", number(m.horizontal.rmse_m)}};
  return result;
}

Json accuracy_json(const AccuracyMetrics& m, bool known) {
  Json result = {{"footprint_bins", known ? Json(m.footprint_bins) : Json(nullptr)},
                 {"quantile", known ? number(m.quantile) : Json(nullptr)}};
  result["absolute"] = {{"x", absolute_json(m.absolute.x)},
                        {"y", absolute_json(m.absolute.y)},
                        {"z", absolute_json(m.absolute.z)},
                        {"horizontal",
                         {{"p95_m", number(m.absolute.horizontal.p95_m)},
                          {"within_limit_frac", number(m.absolute.horizontal.within_limit_frac)}}}};
  result["relative"] = {{"x", relative_json(m.relative.x, known)},
                        {"y", relative_json(m.relative.y, known)},
                        {"z", relative_json(m.relative.z, known)}};
  if (m.absolute.z_corrected) result["absolute"]["z_corrected"] = absolute_json(*m.absolute.z_corrected);
  if (m.relative.z_corrected)
    result["relative"]["z_corrected"] = relative_json(*m.relative.z_corrected, known);
  return result;
}

const char* shape_name(RegionShape shape) {
  return shape == RegionShape::circle ? "circle" : shape == RegionShape::square ? "square" : "mask";
}

/// One member of all elements.
template <class Element, class Value>
Json column(const std::vector<Element>& elements, Value Element::*value) {
  Json list = Json::array();
  for (const Element& element : elements) list.push_back(element.*value);
  return list;
}

Json scores_json(const ScoreMetrics& m) {
  using Count = ScoreMetrics::OfCount;
  using Sigma = ScoreMetrics::OfSigma;
  return {{"count", m.count},
          {"left_out_count", m.left_out_count},
          {"mean", number(m.mean)},
          {"std", number(m.std)},
          {"within_1_sigma_frac", number(m.within_1_sigma_frac)},
          {"within_2_sigma_frac", number(m.within_2_sigma_frac)},
          {"by_count",
           {{"count", column(m.by_count, &Count::count)},
            {"bins", column(m.by_count, &Count::bins)},
            {"std", column(m.by_count, &Count::std)},
            {"within_1_sigma_frac", column(m.by_count, &Count::within_1_sigma_frac)},
            {"within_2_sigma_frac", column(m.by_count, &Count::within_2_sigma_frac)}}},
          {"reliability",
           {{"sigma_m", column(m.reliability, &Sigma::sigma_m)},
            {"rmse_m", column(m.reliability, &Sigma::rmse_m)},
            {"bins", column(m.reliability, &Sigma::bins)}}},
          {"within_k_sigma",
           {{"k", column(m.shares, &ScoreMetrics::Share::k)},
            {"frac", column(m.shares, &ScoreMetrics::Share::within_frac)}}}};
}

Json requirement_json(const Requirement& r) {
  return {{"value", number(r.value)}, {"limit", number(r.limit)}, {"pass", verdict(r.pass)}};
}

}  // namespace

Json metrics_json(const Metrics& m) {
  Json result = {{"format", "landfall.metrics"}, {"version", 1}, {"pass", verdict(m.pass)}};
  result["region"] = {{"radius_m", number(m.region.radius_m)},
                      {"bin_count", m.region.bin_count},
                      {"shape", shape_name(m.region.shape)},
                      {"half_width_m", number(m.region.half_width_m)}};
  result["coverage"] = coverage_json(m.coverage);
  result["accuracy"] = accuracy_json(m.accuracy.value_or(AccuracyMetrics{}), m.accuracy.has_value());
  result["requirements"] = {{"coverage", requirement_json(m.requirements.coverage)},
                            {"hole_size", requirement_json(m.requirements.hole_size)},
                            {"hole_distance", requirement_json(m.requirements.hole_distance)},
                            {"relative_elevation", requirement_json(m.requirements.relative_elevation)},
                            {"relative_horizontal", requirement_json(m.requirements.relative_horizontal)},
                            {"absolute_horizontal", requirement_json(m.requirements.absolute_horizontal)}};
  result["statistics"] = statistics_json(m.statistics);
  result["uncertainty"] = nullptr;
  if (m.uncertainty)
    result["uncertainty"] = {{"absolute", scores_json(m.uncertainty->absolute)},
                             {"relative", scores_json(m.uncertainty->relative)}};
  return result;
}

}  // namespace landfall
