// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/json_values.h"
#include "config/scan_components.h"
#include "scanner/line_search.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

std::unique_ptr<const Pattern> make_line_search(const Json& json, const ComponentContext&) {
  LineSearchParameters pattern;
  pattern.rows = json.at("rows").get<int>();
  pattern.columns = json.at("columns").get<int>();
  pattern.half_width_m = json.at("half_width_m").get<double>();
  pattern.direction =
      json.at("direction") == "boustrophedon" ? LineDirection::boustrophedon : LineDirection::unidirectional;
  pattern.compensated = json.at("compensated").get<bool>();
  pattern.at_end = json.at("at_end") == "stop" ? AtEnd::stop : AtEnd::wrap;
  return std::make_unique<LineSearch>(pattern);
}

constexpr ComponentMaker<Pattern> kPatterns[] = {
    {"line_search", make_line_search},
};

}  // namespace

std::unique_ptr<const Pattern> make_pattern(const Json& scanner, const ComponentContext& context) {
  if (!scanner.contains("pattern")) return nullptr;
  return make_component<Pattern>(kPatterns, scanner.at("pattern"), context);
}

}  // namespace landfall
