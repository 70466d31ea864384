// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/metrics_json.h"

#include <cmath>

#include "chain/evaluation/verdict_text.h"
#include "store/files/field_json.h"

namespace landfall {

NLOHMANN_JSON_SERIALIZE_ENUM(RegionShape, {{RegionShape::circle, "circle"},
                                           {RegionShape::square, "square"},
                                           {RegionShape::mask, "mask"},
                                           {RegionShape::polygon, "polygon"}})

nlohmann::ordered_json metrics_json(const Metrics& metrics) {
  nlohmann::ordered_json json = {{"format", "landfall.metrics"}, {"version", 2}};
  json.update(fields_json(metrics));
  if (!metrics.uncertainty) json["uncertainty"] = nullptr;
  for (const RequirementVerdict& verdict : metrics.requirements.all)
    if (verdict.reason) json["requirements"][verdict.requirement.name]["reason"] = *verdict.reason;
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

RequirementVerdicts own_verdicts_from(const nlohmann::ordered_json& result) {
  RequirementVerdicts own;
  if (!result.contains("own_requirements")) return own;
  for (const auto& [name, verdict] : result.at("own_requirements").items()) {
    own.all.push_back(fields_from<RequirementVerdict>(verdict));
    own.all.back().requirement.name = name;
  }
  return own;
}

Metrics metrics_from(const nlohmann::ordered_json& json) {
  auto metrics = fields_from<Metrics>(json);
  for (RequirementVerdict& verdict : metrics.requirements.all) {
    const auto& requirement = json.at("requirements").at(verdict.requirement.name);
    if (requirement.contains("reason")) requirement.at("reason").get_to(verdict.reason.emplace());
    // JSON has no infinity, but metrics are read as one. A judged footprint has none.
    if (!verdict.value && verdict.pass == false) {
      const auto value = number_at(metrics, verdict.requirement.metric);
      if (value && std::isinf(*value)) verdict.value = value;
    }
  }
  metrics.own_requirements = own_verdicts_from(json);
  return metrics;
}

}  // namespace landfall
