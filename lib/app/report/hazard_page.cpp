// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/hazard_page.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "app/report/escape.h"
#include "app/report/heading.h"
#include "app/report/page_parts.h"
#include "app/report/verdicts.h"
#include "base/dictionary/layers.h"
#include "base/text/number_text.h"
#include "store/files/hazard_file.h"

namespace landfall::html_report {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kMeasureSteps =
    2000;  // of slopes and roughnesses, whose digits of noise would enlarge the file
constexpr int kCostSteps = 5000;

/// 2^value in the region, 0 outside.
Grid<std::int8_t> bits_of(const Grid<std::int8_t>& values, const BinMask& region) {
  Grid<std::int8_t> bits(values.spec());
  for (std::size_t i = 0; i < values.spec().size(); ++i)
    if (region.values()[i] != 0) bits.values()[i] = static_cast<std::int8_t>(1 << values.values()[i]);
  return bits;
}

std::int64_t bit_of(HazardOutcome outcome) { return std::int64_t{1} << static_cast<int>(outcome); }

/// With the number of places of each value.
std::vector<LayerClass> with_counts(const char* layer, const std::vector<std::int64_t>& counts) {
  std::vector<LayerClass> result;
  for (const dictionary::PlaceClass& c : dictionary::place_classes(layer)) {
    const auto value = static_cast<std::size_t>(c.value);
    result.push_back({std::int64_t{1} << value, c.name, c.color, counts.at(value)});
  }
  return result;
}

std::vector<LayerClass> outcome_classes(const HazardScore::Counts& counts) {
  std::vector<LayerClass> classes = with_counts(
      "outcome",
      {counts.hazard_hazard, counts.safe_safe, counts.safe_hazard, counts.hazard_safe, counts.unknown});
  for (LayerClass& c : classes)
    c.is_mark = c.bit == bit_of(HazardOutcome::missed_hazard) || c.bit == bit_of(HazardOutcome::false_alarm);
  return classes;
}

/// The layers in the order of the page.
class Layers {
 public:
  Layers(const HazardReport& content, std::int64_t factor, Packer& packer)
      : content_(content), factor_(factor), packer_(packer) {}

  [[nodiscard]] OrderedJson all(const std::string& elevation) {
    const HazardMap& map = content_.map;
    const PlaceCounts counts = count_places(map.safe, map.region);
    add_classes("safe", map.safe, with_counts("safe", {counts.hazard, counts.safe, counts.unknown}));
    if (map.truth) add_classes("outcome", map.truth->outcome, outcome_classes(map.truth->score.counts));
    add_probabilities();
    add_measures(map.measures, "");
    if (map.truth) add_measures(map.truth->measures, "_true");
    add_elevations(elevation);
    return std::move(list_);
  }

 private:
  template <class T>
  void add(ReportLayer layer, const Grid<T>& values) {
    const std::string id = layer.name;
    list_.push_back(packer_.keep(reduced_layer(std::move(layer), values, factor_), id));
  }

  void add_elevations(const std::string& elevation) {
    ReportLayer layer = described(elevation == "z" ? "terrain" : "dem", elevation);
    layer.title = "Elevation, small holes filled";
    layer.group = described("hazards", "slope").group;
    add(layer, content_.input.z);
    if (!content_.input.z_true) return;
    ReportLayer truth = described("dem", "z_true");
    truth.group = described("hazards", "slope_true").group;
    add(truth, *content_.input.z_true);
  }

  void add_classes(const std::string& name, const Grid<std::int8_t>& values,
                   std::vector<LayerClass> classes) {
    ReportLayer layer = described("hazards", name);
    layer.classes = std::move(classes);
    add(std::move(layer), bits_of(values, content_.map.region));
  }

  void add_probabilities() {
    const HazardMap& map = content_.map;
    if (map.p_safe) add(described("hazards", "p_safe"), *map.p_safe);
    ReportLayer touchdown = described("hazards", "p_touchdown");
    if (!map.p_safe) touchdown.title = "Share of touchdowns that meet places judged safe, no probability";
    add(std::move(touchdown), map.p_touchdown);
    ReportLayer cost = described("hazards", "cost");
    cost.steps = kCostSteps;
    add(std::move(cost), map.cost);
    add(described("hazards", "distance_to_hazard"), map.hazard_distance);
  }

  void add_measure(const std::string& name, double limit, const Grid<double>& values) {
    ReportLayer layer = described("hazards", name);
    layer.limit = limit;
    layer.steps = kMeasureSteps;
    add(std::move(layer), values);
  }

  void add_measures(const PlaceMeasures& measures, const std::string& suffix) {
    add_measure("slope" + suffix, content_.parameters.limits.slope_deg, measures.slope_deg);
    add_measure("roughness" + suffix, content_.parameters.limits.roughness_m, measures.roughness_m);
  }

  const HazardReport& content_;
  std::int64_t factor_;
  Packer& packer_;
  OrderedJson list_ = OrderedJson::array();
};

OrderedJson position_json(const GridSpec& spec, BinIndex bin, double z_m) {
  return {{"x_m", spec.x(bin.col)}, {"y_m", spec.y(bin.row)}, {"z_m", z_m}};
}

OrderedJson pose_json(const LanderPose& pose, const Grid<double>& z) {
  OrderedJson pads = OrderedJson::array();
  for (const LanderPose::Pad& pad : pose.pads) {
    pads.push_back(position_json(z.spec(), pad.bin, pad.z_m));
    pads.back()["touches"] = pad.touches;
  }
  return {{"yaw_deg", pose.yaw_rad * 180 / std::numbers::pi},
          {"slope_deg", pose.slope_deg},
          {"roughness_m", pose.roughness_m},
          {"east", pose.east},
          {"north", pose.north},
          {"centre_z_m", pose.centre_z_m},
          {"highest", position_json(z.spec(), pose.highest, z.at(pose.highest))},
          {"pads", std::move(pads)}};
}

OrderedJson poses_json(const std::optional<WorstPoses>& poses, const Grid<double>& z) {
  if (!poses) return nullptr;
  return {{"steepest", pose_json(poses->steepest, z)}, {"roughest", pose_json(poses->roughest, z)}};
}

/// Bins on each side of a site that show the lander with some room.
std::int64_t crop_half_bins(const Lander& lander, double resolution_m) {
  constexpr double kRoom = 1.15;
  const double reach_m = std::max(lander.body_radius_m, lander.leg_radius_m + lander.pad_diameter_m / 2);
  return static_cast<std::int64_t>(std::ceil(kRoom * reach_m / resolution_m)) + 2;
}

OrderedJson sites_of(const HazardReport& content, const std::string& elevation, Packer& packer) {
  OrderedJson sites = sites_json(content.map)["sites"];
  const Grid<double>& z = content.input.z;
  const std::int64_t half = crop_half_bins(content.parameters.lander, z.spec().resolution_m);
  for (std::size_t k = 0; k < std::min(sites.size(), kMaxDrawnSites); ++k) {
    const BinIndex bin = content.map.sites[k].bin;
    const GridSpec window = window_about(bin, half, z.spec());
    const std::int64_t factor = reduction_factor(window, kMaxCropCells);
    ReportLayer layer{elevation, "Elevation", "m"};
    OrderedJson crop = grid_json(window, factor);
    crop["layers"] = {packer.keep(reduced_layer(std::move(layer), cut_out(z, window), factor),
                                  "site-" + std::to_string(k + 1))};
    sites[k]["crop"] = std::move(crop);
    sites[k]["poses"] = poses_json(worst_poses(z, content.parameters, bin), z);
  }
  return sites;
}

OrderedJson lander_json(const Lander& lander) {
  return {{"legs", lander.legs},
          {"leg_radius_m", lander.leg_radius_m},
          {"pad_diameter_m", lander.pad_diameter_m},
          {"body_radius_m", lander.body_radius_m}};
}

std::string share(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? "\u2013" : percent_text(static_cast<double>(part) / static_cast<double>(whole));
}

std::string row(const std::string& name, std::int64_t count, std::int64_t all, const std::string& note) {
  return "<tr><th scope=\"row\">" + name + "</th><td class=\"number\">" + grouped(count) +
         "</td><td class=\"number\">" + share(count, all) + "</td><td>" + note + "</td></tr>\n";
}

std::string table(const std::string& id, const std::string& heading, const std::string& rows) {
  return "<table id=\"" + id + "\"><thead><tr><th>" + heading +
         "</th><th class=\"number\">places</th><th class=\"number\">of the region</th><th></th></tr></thead>"
         "<tbody>\n" +
         rows + "</tbody></table>\n";
}

std::string places_html(const PlaceCounts& counts) {
  return table("places", "on the map",
               row("safe", counts.safe, counts.all(), "") + row("hazard", counts.hazard, counts.all(), "") +
                   row("unknown", counts.unknown, counts.all(),
                       "a part of the lander lies on a bin without an elevation, or beyond the map"));
}

std::string outcomes_html(const HazardScore::Counts& n, std::int64_t all) {
  const std::int64_t hazards = n.safe_hazard + n.hazard_hazard;
  const std::int64_t safe = n.safe_safe + n.hazard_safe;
  return table("outcomes", "compared with the truth",
               row("missed hazard", n.safe_hazard, all,
                   share(n.safe_hazard, hazards) + " of the " + grouped(hazards) + " true hazards") +
                   row("false alarm", n.hazard_safe, all,
                       share(n.hazard_safe, safe) + " of the " + grouped(safe) + " truly safe places") +
                   row("hazard found", n.hazard_hazard, all, "") + row("safe found", n.safe_safe, all, "") +
                   row("unknown", n.unknown, all, "on the map or on the true terrain"));
}

std::string metres(double value) { return number_text(value) + " m"; }

std::string lander_text(const HazardParameters& parameters, const std::string& method) {
  const Lander& lander = parameters.lander;
  const std::string legs = parameters.method == HazardMethod::contact
                               ? std::to_string(lander.legs) + " legs at " + metres(lander.leg_radius_m) +
                                     " from the centre, pads of " + metres(lander.pad_diameter_m) + ", "
                               : "";
  return "Lander: " + legs + "body of " + metres(2 * lander.body_radius_m) + "; method " + method +
         ". A place is safe if its slope is at most " + number_text(parameters.limits.slope_deg) +
         " deg and its roughness at most " + metres(parameters.limits.roughness_m) +
         ". Places are the bins " + region_text(parameters) + "; a touchdown is off its target by " +
         metres(parameters.touchdown_sigma_m) + " (1 sigma along x and y).";
}

std::string assumptions_text(const HazardReport& content) {
  std::string text = "Assumptions: bins of " + metres(content.map.safe.spec().resolution_m);
  if (content.truth_spacing_m) text += "; truth nodes every " + metres(*content.truth_spacing_m);
  return text + ".";
}

std::string place_text(const LandingSite& site, bool has_probability) {
  return "(" + short_number(site.x_m) + ", " + short_number(site.y_m) + ") m" +
         (has_probability
              ? " has a p_touchdown of " + std::string(is_touchdown_capped(site) ? "at least " : "") +
                    probability_text(static_cast<double>(site.p_touchdown))
              : std::string("; ") + kNoProbability);
}

/// Whether --require-safe accepts the map.
std::string banner_html(const HazardMap& map, const RequirementVerdicts& own, double min_p) {
  const std::vector<LandingSite>& sites = map.sites;
  const auto best = std::ranges::max_element(sites, {}, &LandingSite::p_touchdown);
  const bool has_site = best != sites.end() && best->p_touchdown >= min_p;
  const bool accepted = has_site && all_pass(own);
  std::string text = "no landing site: no safe place within reach";
  if (!sites.empty())
    text = (has_site ? "" : "no site has a p_touchdown of " + number_text(min_p) + " or more: ") +
           std::string("the best site ") + place_text(sites.front(), map.p_safe.has_value());
  if (!all_pass(own)) text += "; " + own_missed_text(own);
  return std::string("<div class=\"banner ") + (accepted ? "pass" : "fail") + "\" id=\"verdict\">" + text +
         "</div>";
}

}  // namespace

OrderedJson outline_json(const ReachableArea& area) {
  OrderedJson vertices = OrderedJson::array();
  for (const Horizontal& vertex : area.outline()) vertices.push_back({vertex.x, vertex.y});
  return vertices;
}

OrderedJson region_json(RegionShape shape, double radius_m, Horizontal center_m, double half_width_m) {
  switch (shape) {
    case RegionShape::circle:
      return {{"shape", "circle"},
              {"radius_m", radius_m},
              {"center_x_m", center_m.x},
              {"center_y_m", center_m.y}};
    case RegionShape::square:
      return {{"shape", "square"}, {"half_width_m", half_width_m}};
    case RegionShape::mask:
      return {{"shape", "mask"}};
    case RegionShape::polygon:
      return {{"shape", "polygon"}};
  }
  return {};
}

ReportData hazard_data(const HazardReport& content, const std::string& elevation, std::int64_t max_cells) {
  const HazardParameters& parameters = content.parameters;
  const GridSpec& spec = content.input.z.spec();
  const std::int64_t factor = reduction_factor(spec, max_cells);
  const double body_bins = std::floor((parameters.lander.body_radius_m + 1e-9) / spec.resolution_m);
  Packer packer;
  ReportData data;
  data.values = {
      {"grid", grid_json(spec, factor)},
      {"region",
       region_json(parameters.region_shape, parameters.region_radius_m, parameters.region_center_m)},
      {"footprint",
       {{"shape", "disc"},
        {"text", "lander"},
        {"width_m", 2 * parameters.lander.body_radius_m},
        {"half_bins", body_bins}}},
      {"lander", lander_json(parameters.lander)},
      {"limits",
       {{"slope_deg", parameters.limits.slope_deg}, {"roughness_m", parameters.limits.roughness_m}}},
      {"reach", outline_json(reachable_area(parameters.sites))},
      {"colors", colors_json()},
      {"places", count_places(content.map.safe, content.map.region).all()},
      {"layers", Layers(content, factor, packer).all(elevation)},
      {"groups", groups_json("hazards")},
      {"sites", sites_of(content, elevation, packer)},
      {"score", content.map.truth ? score_json(content.map.truth->score) : OrderedJson(nullptr)}};
  data.packed = packer.pack();
  return data;
}

std::string hazard_page(const HazardReport& content, const Provenance& provenance, const std::string& title) {
  nlohmann::json steps = provenance.chain;
  steps.push_back(provenance.as_step());
  const std::string kind = provenance.inputs.empty() ? "dem" : provenance.inputs.front().role;
  const HazardMap& map = content.map;
  const PlaceCounts counts = count_places(map.safe, map.region);
  std::string tables = places_html(counts);
  if (map.truth) tables += outcomes_html(map.truth->score.counts, counts.all());
  const RequirementVerdicts own = own_verdicts(map, content.parameters);
  tables += own_table_html(own);
  return page_html("hazards.html",
                   {{"title", html_text(title.empty() ? title_of(steps, "Landing sites") : title)},
                    {"subtitle", subtitle_html(steps, "hazard map", kind == "dem" ? "DEM" : "terrain", kind)},
                    {"banner", banner_html(map, own, content.parameters.sites.min_p)},
                    {"places", tables},
                    {"lander", lander_text(content.parameters, text_of(provenance.config, "method"))},
                    {"assumptions", assumptions_text(content)},
                    {"provenance", provenance_html(steps, "this hazard map")},
                    {"data", data_html(hazard_data(content, kind == "dem" ? "z_est" : "z"))}});
}

}  // namespace landfall::html_report
