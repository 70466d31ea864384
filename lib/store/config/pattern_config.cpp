// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/patterns.h"
#include "store/config/json_values.h"
#include "store/config/scan_components.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using Pair = std::array<double, 2>;

bool is_compensated(const Json& json) { return json.at("compensated").get<bool>(); }

LineDirection line_direction(const Json& json) {
  return json.at("direction") == "boustrophedon" ? LineDirection::boustrophedon
                                                 : LineDirection::unidirectional;
}

AtEnd at_end(const Json& json) { return json.at("at_end") == "stop" ? AtEnd::stop : AtEnd::wrap; }

std::unique_ptr<const Pattern> make_line_search(const Json& json, const ComponentContext&) {
  return std::make_unique<LineSearch>(
      LineSearchParameters{.rows = json.at("rows").get<int>(),
                           .columns = json.at("columns").get<int>(),
                           .half_width_m = json.at("half_width_m").get<double>(),
                           .direction = line_direction(json),
                           .compensated = is_compensated(json),
                           .at_end = at_end(json),
                           .ramped = json.at("ramped").get<bool>()});
}

std::unique_ptr<const Pattern> make_spiral(const Json& json, const ComponentContext&) {
  return std::make_unique<Spiral>(SpiralParameters{
      .radius_m = json.at("radius_m").get<double>(),
      .pitch_m = json.at("pitch_m").get<double>(),
      .inner_radius_m = json.at("inner_radius_m").get<double>(),
      .period_s = json.at("period_s").get<double>(),
      .direction = json.at("direction") == "inward" ? SpiralDirection::inward : SpiralDirection::outward,
      .compensated = is_compensated(json)});
}

std::unique_ptr<const Pattern> make_rosette(const Json& json, const ComponentContext&) {
  const auto phases_deg = json.at("phases_deg").get<Pair>();
  return std::make_unique<Rosette>(
      RosetteParameters{.radius_m = json.at("radius_m").get<double>(),
                        .rates_hz = json.at("rates_hz").get<Pair>(),
                        .phases_rad = {kRadiansPerDegree * phases_deg[0], kRadiansPerDegree * phases_deg[1]},
                        .compensated = is_compensated(json)});
}

std::unique_ptr<const Pattern> make_lissajous(const Json& json, const ComponentContext&) {
  const Json& half = json.at("half_width_m");  // a number is used for both axes
  return std::make_unique<Lissajous>(LissajousParameters{
      .half_width_m = half.is_array() ? half.get<Pair>() : Pair{half.get<double>(), half.get<double>()},
      .rates_hz = json.at("rates_hz").get<Pair>(),
      .phase_rad = radians(json, "phase_deg"),
      .compensated = is_compensated(json)});
}

std::unique_ptr<const Pattern> make_stare(const Json& json, const ComponentContext&) {
  return std::make_unique<Stare>(
      StareParameters{.aim_m = json.at("aim_m").get<Pair>(), .compensated = is_compensated(json)});
}

std::unique_ptr<const Pattern> make_step_stare(const Json& json, const ComponentContext&) {
  return std::make_unique<StepStare>(
      StepStareParameters{.rows = json.at("rows").get<int>(),
                          .columns = json.at("columns").get<int>(),
                          .half_width_m = json.at("half_width_m").get<double>(),
                          .pulses_per_step = json.at("pulses_per_step").get<int>(),
                          .direction = line_direction(json),
                          .compensated = is_compensated(json),
                          .at_end = at_end(json)});
}

AtTableEnd at_table_end(const Json& json) {
  if (json.at("at_end") == "hold") return AtTableEnd::hold;
  return json.at("at_end") == "wrap" ? AtTableEnd::wrap : AtTableEnd::stop;
}

std::unique_ptr<const Pattern> make_table_pattern(const Json& json, const ComponentContext& context) {
  if (!context.load_table) return std::make_unique<Stare>(StareParameters{});
  const NumberTable table = context.load_table(json.at("path").get<std::string>(), "pattern", aim_columns());
  return std::make_unique<TablePattern>(
      TablePatternParameters{aim_samples(table), at_table_end(json), is_compensated(json)},
      table.file() + ": pattern table");
}

constexpr ComponentMaker<Pattern> kPatterns[] = {
    {"line_search", make_line_search}, {"spiral", make_spiral}, {"rosette", make_rosette},
    {"lissajous", make_lissajous},     {"stare", make_stare},   {"step_stare", make_step_stare},
    {"table", make_table_pattern},
};

}  // namespace

std::unique_ptr<const Pattern> make_pattern(const Json& scanner, const ComponentContext& context) {
  if (!scanner.contains("pattern")) return nullptr;
  return make_component<Pattern>(kPatterns, scanner.at("pattern"), context);
}

}  // namespace landfall
