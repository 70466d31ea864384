// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/metrics_json.h"

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
  return result;
}

Json requirement_json(const Requirement& r) {
  return {{"value", number(r.value)}, {"limit", number(r.limit)}, {"pass", verdict(r.pass)}};
}

}  // namespace

Json metrics_json(const Metrics& m) {
  Json result = {{"format", "landfall.metrics"}, {"version", 1}, {"pass", verdict(m.pass)}};
  result["region"] = {{"radius_m", number(m.region.radius_m)}, {"bin_count", m.region.bin_count}};
  result["coverage"] = coverage_json(m.coverage);
  result["accuracy"] = accuracy_json(m.accuracy.value_or(AccuracyMetrics{}), m.accuracy.has_value());
  result["requirements"] = {{"coverage", requirement_json(m.requirements.coverage)},
                            {"hole_size", requirement_json(m.requirements.hole_size)},
                            {"hole_distance", requirement_json(m.requirements.hole_distance)},
                            {"relative_elevation", requirement_json(m.requirements.relative_elevation)},
                            {"relative_horizontal", requirement_json(m.requirements.relative_horizontal)},
                            {"absolute_horizontal", requirement_json(m.requirements.absolute_horizontal)}};
  return result;
}

}  // namespace landfall
