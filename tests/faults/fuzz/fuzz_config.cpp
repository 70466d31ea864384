// SPDX-License-Identifier: GPL-3.0-or-later
// Configurations: JSON text and --set, as the tools take them up to the work itself.
//
// An input is a letter (t: terrain-gen, i: terrain-gen with the options of an import, s: scan-sim, r: regrid,
// u: regrid --uncertainty, e: dem-eval, h: hazard-map, m: monte-carlo), the configuration, and any number of
// further texts, each after a zero byte: assignments for --set; for i the values of the import's options
// first; for u those of --navigation-sigma.
#include <algorithm>
#include <array>
#include <vector>

#include "base/text/json_text.h"
#include "chain/lidar/simulation/simulation.h"
#include "chain/ray/flat_terrain.h"
#include "fuzz_target.h"
#include "store/config/dem_config.h"
#include "store/config/draws_config.h"
#include "store/config/hazard_config.h"
#include "store/config/import_config.h"
#include "store/config/region_config.h"
#include "store/config/scan_config.h"
#include "store/config/schema.h"
#include "store/config/stage_sections.h"
#include "store/config/terrain_config.h"
#include "store/config/uncertainty_config.h"

namespace landfall::fuzz {
namespace {

using Json = nlohmann::json;
using Texts = std::vector<std::string>;

constexpr const char* kName = "config.json";

Texts texts_of(InputBytes& input) {
  Texts texts;
  while (!input.at_end()) texts.push_back(input.until(0));
  return texts;
}

/// The output of --print-config is a configuration, and resolves to itself.
Json resolve(const JsonSource& source, const std::string& schema) {
  const Json resolved = resolve_config(source, embedded_schema(schema));
  if (resolve_config({kName, resolved}, embedded_schema(schema)) != resolved)
    throw BrokenPromise("a resolved configuration resolves to another: " + resolved.dump());
  return resolved;
}

JsonSource source_of(const std::string& text, const Texts& assignments) {
  JsonSource source = parse_json(text, kName);
  apply_assignments(source, assignments);
  return source;
}

void use_terrain(const JsonSource& source) {
  static_cast<void>(terrain_config(resolve_terrain_config(source), kName));
}

void use_import(const std::string& text, Texts texts) {
  constexpr std::array kOptions = {
      &ImportOptions::from,           &ImportOptions::center,           &ImportOptions::center_pixel,
      &ImportOptions::band,           &ImportOptions::interpolation,    &ImportOptions::datum,
      &ImportOptions::vertical_scale, &ImportOptions::horizontal_scale, &ImportOptions::nodata,
      &ImportOptions::half_width,     &ImportOptions::resolution};
  texts.resize(std::max(texts.size(), kOptions.size()));
  ImportOptions options;
  for (std::size_t i = 0; i < kOptions.size(); ++i) options.*kOptions[i] = texts[i];
  options.from = options.from.substr(0, 100);  // a path is named in full
  JsonSource source = parse_json(text, kName);
  apply_import(source, options);
  apply_assignments(source, {texts.begin() + kOptions.size(), texts.end()});
  if (!options.from.empty())
    complete_import(source, options, [](const DemBase&, const SiteRequest&) { return SiteSize{10, 1}; });
  use_terrain(source);
}

/// Rays that a detector makes of each pulse; a configuration may ask for many, and gets them.
double ray_count(const Json& detector) {
  const auto number = [&](const char* key) { return detector.at(key).get<double>(); };
  return number("rows") * number("columns") * number("subpixels") * number("subpixels");
}

/// Time steps of a trajectory that is integrated when it is made.
double step_count(const Json& resolved) {
  const Json& trajectory = resolved.at("trajectory");
  if (!trajectory.contains("control_period_s")) return 0;
  return resolved.at("laser").at("scan_time_s").get<double>() /
         trajectory.at("control_period_s").get<double>();
}

/// The first and the last pulse over flat terrain.
void simulate(ScanModel model) {
  const FlatTerrain ground;
  const Simulation simulation(std::move(model), &ground, &ground);
  static_cast<void>(simulation.simulate({0, 1}));
  static_cast<void>(simulation.simulate({simulation.pulse_count() - 1, 1}));
}

void use_scan(const JsonSource& source) {
  const Json resolved = completed_scan_config(resolve(source, "scan"));
  if (ray_count(resolved.at("detector")) > 4096 || step_count(resolved) > 4096) return;
  ScanModel model = scan_model(resolved, kName, {});
  static_cast<void>(accepts("", [&] { simulate(std::move(model)); }));
}

void use_regrid(const JsonSource& source) {
  static_cast<void>(regrid_config(resolve(source, "regrid"), kName));
}

void use_uncertainty(const std::string& text, const Texts& sigmas) {
  Json resolved = resolve(parse_json(text, kName), "regrid");
  for (const std::string& sigma : sigmas) add_navigation_sigma(resolved, sigma);
  static_cast<void>(regrid_config(resolved, kName));
  static_cast<void>(uncertainty_parameters(resolved, kName, {{"scan.h5", Json::object()}}));
}

void use_eval(const JsonSource& source) {
  const Json resolved = resolve(source, "eval");
  static_cast<void>(evaluation_config(resolved, kName));
  static_cast<void>(region_config(resolved, kName));
}

void use_hazards(const JsonSource& source) {
  const HazardParameters parameters = hazard_config(resolve(source, "hazard"));
  const Lander& lander = parameters.lander;
  static_cast<void>(LanderStencil(
      lander, std::max({lander.leg_radius_m, lander.body_radius_m, lander.pad_diameter_m}) / 20));
}

void use_draws(const JsonSource& source) {
  JsonSource expanded = source;
  expand_stage_sections(expanded);
  check_draws_config(resolve(expanded, "draws"), kName, true, nullptr);
}

void use(std::uint8_t tool, const std::string& text, const Texts& texts) {
  if (!std::all_of(texts.begin(), texts.end(), is_utf8)) return;  // refused before anything is read
  switch (tool) {
    case 't':
      return use_terrain(source_of(text, texts));
    case 'i':
      return use_import(text, texts);
    case 's':
      return use_scan(source_of(text, texts));
    case 'r':
      return use_regrid(source_of(text, texts));
    case 'u':
      return use_uncertainty(text, texts);
    case 'e':
      return use_eval(source_of(text, texts));
    case 'h':
      return use_hazards(source_of(text, texts));
    case 'm':
      return use_draws(source_of(text, texts));
    default:
      return;
  }
}

}  // namespace
}  // namespace landfall::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace landfall::fuzz;
  InputBytes input({data, size});
  const std::uint8_t tool = input.byte();
  const std::string text = input.until(0);
  static_cast<void>(accepts("", [&] { use(tool, text, texts_of(input)); }));
  return 0;
}
