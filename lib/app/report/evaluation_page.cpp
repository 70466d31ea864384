// SPDX-License-Identifier: GPL-3.0-or-later
// A report names no file and no time, only file_ids: equal evaluations give equal bytes, whatever the name
// of the DEM.
#include "app/report/evaluation_page.h"

#include <algorithm>
#include <utility>

#include "app/report/escape.h"
#include "app/report/heading.h"
#include "app/report/page_parts.h"
#include "app/report/verdicts.h"
#include "base/dictionary/layers.h"
#include "formats/gdal/gdal_loader.h"
#include "store/files/field_json.h"
#include "store/files/map_position_json.h"
#include "store/files/metrics_json.h"

namespace landfall::html_report {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::size_t kMaxHoles = 10;

OrderedJson footprint_json(const EvaluationParameters& parameters, double resolution_m) {
  return {{"shape", parameters.footprint_shape == FootprintShape::square ? "square" : "disc"},
          {"text", "footprint"},
          {"width_m", parameters.footprint_m},
          {"half_bins", footprint_of(parameters, resolution_m).half_bins()}};
}

/// Adds the coordinates on the map of a site that has a CRS to objects with x_m and y_m.
void place_on_map(OrderedJson& places, const std::string& crs_wkt) {
  std::vector<SitePoint> points;
  for (const OrderedJson& place : places)
    points.push_back({place["x_m"].is_number() ? place["x_m"].get<double>() : 0,
                      place["y_m"].is_number() ? place["y_m"].get<double>() : 0});
  const std::vector<MapPosition> positions = map_positions(crs_wkt, points);
  for (std::size_t i = 0; i < points.size(); ++i) places[i].update(map_position_json(positions[i]));
}

/// Sorted by size, the largest first; equal sizes keep their order.
OrderedJson holes_json(std::vector<Hole> holes, const GridSpec& spec, const std::string& crs_wkt) {
  std::ranges::stable_sort(holes, [](const Hole& a, const Hole& b) { return a.size_bins > b.size_bins; });
  holes.resize(std::min(holes.size(), kMaxHoles));
  OrderedJson list = OrderedJson::array();
  for (const Hole& hole : holes)
    list.push_back(
        {{"size_bins", hole.size_bins},
         {"x_m", finite_json(hole.centroid_x_m)},
         {"y_m", finite_json(hole.centroid_y_m)},
         {"width_m", static_cast<double>(hole.north_east.col - hole.south_west.col + 1) * spec.resolution_m},
         {"height_m", static_cast<double>(hole.north_east.row - hole.south_west.row + 1) * spec.resolution_m},
         {"distance_bins", finite_json(hole.depth_bins)}});
  place_on_map(list, crs_wkt);
  return list;
}

OrderedJson crop_json(const WorstFootprint& f, const EvaluationLimits& limits, const std::string& id,
                      Packer& packer) {
  const std::int64_t factor = reduction_factor(f.window, kMaxCropCells);
  const bool horizontal = f.axis == 'h';
  const std::string axis(1, f.axis);
  ReportLayer error{horizontal ? "e_xy" : "e_" + axis, horizontal ? "Horizontal error" : "Error in " + axis,
                    "m", horizontal ? Style::magnitude : Style::signed_error, Rule::extreme};
  error.limit = limit_of_layer(limits, error.name);
  OrderedJson crop = grid_json(f.window, factor);
  crop["layers"] = {
      packer.keep(reduced_layer({"z_est", "Estimated elevation", "m"}, f.z_est, factor), id + "-z_est"),
      packer.keep(reduced_layer(std::move(error), f.error, factor), id + "-error")};
  return crop;
}

OrderedJson worst_json(const ReportContent& content, Packer& packer) {
  OrderedJson list = OrderedJson::array();
  const GridSpec& spec = content.layers.spec();
  for (const WorstFootprint& f : content.worst) {
    const std::string id = "worst-" + std::to_string(list.size() + 1);
    list.push_back(
        {{"x_m", spec.x(f.bin.col)},
         {"y_m", spec.y(f.bin.row)},
         {"requirement", f.requirement},
         {"axis", std::string(1, f.axis)},
         {"share", finite_json(f.share)},
         {"relative_m",
          {finite_json(f.relative_m[0]), finite_json(f.relative_m[1]), finite_json(f.relative_m[2])}},
         {"absolute_m",
          {finite_json(f.absolute_m[0]), finite_json(f.absolute_m[1]), finite_json(f.absolute_m[2])}},
         {"horizontal_m", finite_json(f.horizontal_m)},
         {"crop", crop_json(f, content.parameters.limits, id, packer)}});
  }
  place_on_map(list, content.crs_wkt);
  return list;
}

/// A bin has the colour of the first of its flags.
OrderedJson fail_flags_json() {
  OrderedJson list = OrderedJson::array();
  for (const dictionary::FailFlag& flag : dictionary::kFailFlags)
    list.push_back({{"bits", flag.bit},
                    {"text", flag.text},
                    {"requirement", flag.requirement},
                    {"color", css_color(flag.color)}});
  return list;
}

OrderedJson histograms_json(const ReportLayers& layers) {
  OrderedJson result = OrderedJson::object();
  const std::pair<const char*, Axis> axes[] = {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}};
  for (const auto& [name, axis] : axes)
    result[name] = {{"error", fields_json(layers.histograms(axis).error)},
                    {"relative", fields_json(layers.histograms(axis).relative)}};
  return result;
}

/// The layers of the DEM as they came, then those of the evaluation, which gives z first, in the dictionary's
/// order.
std::vector<const ReportLayer*> in_order(const std::vector<ReportLayer>& layers) {
  std::vector<const ReportLayer*> ordered;
  for (const ReportLayer& layer : layers) ordered.push_back(&layer);
  std::ranges::stable_sort(ordered, {}, [](const ReportLayer* layer) {
    const dictionary::Layer* const words = dictionary::find_layer("evaluation", layer->name);
    return words == nullptr ? -1 : words - dictionary::kLayers.data();
  });
  return ordered;
}

OrderedJson footprint_limits_json(const EvaluationLimits& limits) {
  return {{"relative_m", limits.relative_m()},
          {"horizontal_m", limits.horizontal_m},
          {"horizontal_share", limits.horizontal_share}};
}

ReportData report_data(const ReportContent& content) {
  const ReportLayers& layers = content.layers;
  Packer packer;
  OrderedJson list = OrderedJson::array();
  for (const ReportLayer* const layer : in_order(layers.layers()))
    list.push_back(packer.add(*layer, layer->name));
  OrderedJson metrics = metrics_json(content.evaluation.metrics);
  ReportData data;
  data.values = {{"grid", grid_json(layers.spec(), layers.factor())},
                 {"footprint", footprint_json(content.parameters, layers.spec().resolution_m)},
                 {"limits", fields_json(content.parameters.limits)},
                 {"footprint_limits", footprint_limits_json(content.parameters.limits)},
                 {"quantile", content.parameters.quantile},
                 {"colors", colors_json()},
                 {"region", metrics["region"]},
                 {"metrics", std::move(metrics)},
                 {"layers", std::move(list)},
                 {"groups", groups_json("evaluation")},
                 {"fail_flags", fail_flags_json()},
                 {"fail_count", layers.fail_counts()},
                 {"histograms", histograms_json(layers)},
                 {"holes", holes_json(content.evaluation.holes, layers.spec(), content.crs_wkt)},
                 {"worst", worst_json(content, packer)}};
  data.packed = packer.pack();
  return data;
}

}  // namespace

std::string report_page(const ReportContent& content) {
  const Metrics& metrics = content.evaluation.metrics;
  const std::string title = content.title.empty() ? title_of(content.steps) : content.title;
  return page_html("evaluation.html", {{"title", html_text(title)},
                                       {"subtitle", subtitle_html(content.steps, "evaluation", "DEM", "dem")},
                                       {"banner", verdict_banner_html(metrics)},
                                       {"verdicts", verdict_table_html(metrics, content.parameters.limits)},
                                       {"assumptions", assumptions_html(metrics.assumptions.value())},
                                       {"provenance", provenance_html(content.steps, "this evaluation")},
                                       {"data", data_html(report_data(content))}});
}

Report::Report(const std::filesystem::path& path, const DemLayers& dem, std::string crs_wkt,
               const EvaluationParameters& parameters)
    : ReportLayers(dem.z_est.spec(), parameters),
      parameters_(parameters),
      crs_wkt_(std::move(crs_wkt)),
      dem_(path) {
  take(dem);
  if (const auto count = dem_.count()) take(*count);
}

std::string Report::page(const Evaluation& evaluation, const Provenance& provenance,
                         const std::string& title) const {
  nlohmann::json steps = provenance.chain;
  steps.push_back(provenance.as_step());
  const auto worst =
      worst_footprints(shares(), parameters_, [this](const GridSpec& window) { return dem_.read(window); });
  return report_page({parameters_, evaluation, *this, worst, steps, title, crs_wkt_});
}

}  // namespace landfall::html_report
