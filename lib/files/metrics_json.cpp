// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/metrics_json.h"

#include "evaluation/verdict_text.h"
#include "files/field_json.h"

namespace landfall {

NLOHMANN_JSON_SERIALIZE_ENUM(RegionShape, {{RegionShape::circle, "circle"},
                                           {RegionShape::square, "square"},
                                           {RegionShape::mask, "mask"},
                                           {RegionShape::polygon, "polygon"}})

nlohmann::ordered_json metrics_json(const Metrics& metrics) {
  nlohmann::ordered_json json = {{"format", "landfall.metrics"}, {"version", 2}};
  json.update(fields_json(metrics));
  if (!metrics.uncertainty) json["uncertainty"] = nullptr;
  for (const RequirementInfo& info : kRequirementInfo)
    if (const auto& reason = (metrics.requirements.*info.requirement).reason)
      json["requirements"][info.name]["reason"] = *reason;
  return json;
}

nlohmann::ordered_json verdict_json(const Metrics& metrics, const EvaluationLimits& limits) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const VerdictText& text : verdict_texts(metrics, limits))
    rows.push_back({{"requirement", text.name},
                    {"measured", text.value},
                    {"limit", text.limit},
                    {"verdict", text.verdict}});
  return rows;
}

OwnVerdicts own_verdicts_from(const nlohmann::ordered_json& result) {
  OwnVerdicts own;
  if (!result.contains("own_requirements")) return own;
  for (const auto& [name, verdict] : result.at("own_requirements").items()) {
    own.all.push_back(fields_from<OwnVerdict>(verdict));
    own.all.back().requirement.name = name;
  }
  return own;
}

Metrics metrics_from(const nlohmann::ordered_json& json) {
  auto metrics = fields_from<Metrics>(json);
  metrics.requirements.hole_distance.value = metrics.coverage.max_distance_bins;  // JSON has no infinity
  for (const RequirementInfo& info : kRequirementInfo)
    if (const auto& requirement = json.at("requirements").at(info.name); requirement.contains("reason"))
      requirement.at("reason").get_to((metrics.requirements.*info.requirement).reason.emplace());
  metrics.own_requirements = own_verdicts_from(json);
  return metrics;
}

}  // namespace landfall
