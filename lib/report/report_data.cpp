// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/report_data.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <span>

#include "base/parallel.h"
#include "files/field_json.h"
#include "files/metrics_json.h"
#include "picture/color_map.h"

namespace landfall::html_report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMaxCropCells = 512;
constexpr std::size_t kMaxHoles = 10;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

const char* name_of(Style style) {
  switch (style) {
    case Style::elevation:
      return "elevation";
    case Style::signed_error:
      return "signed";
    case Style::magnitude:
      return "magnitude";
    case Style::count:
      return "count";
    case Style::mask:
      return "mask";
    case Style::flags:
      return "flags";
  }
  return "";
}

/// Empty for masks and flags, whose marks have their own colours.
std::string colors_of(Style style) {
  switch (style) {
    case Style::elevation:
      return name_of(Colors::elevation);
    case Style::signed_error:
      return name_of(Colors::error);
    case Style::magnitude:
      return name_of(Colors::magnitude);
    case Style::count:
      return name_of(Colors::count);
    case Style::mask:
    case Style::flags:
      return "";
  }
  return "";
}

/// The colour maps of lib/picture, which the page's scripts use too.
Json colors_json() {
  Json maps = Json::object();
  for (std::size_t k = 0; k < kColorMaps; ++k) {
    const auto colors = static_cast<Colors>(k);
    Json anchors = Json::array();
    for (const std::uint32_t rrggbb : color_anchors(colors)) anchors.push_back(rrggbb);
    maps[name_of(colors)] = std::move(anchors);
  }
  return {{"maps", std::move(maps)}, {"no_value", kNoValueColor}, {"mark", kMarkColor}};
}

const char* name_of(Rule rule) {
  switch (rule) {
    case Rule::mean:
      return "mean";
    case Rule::extreme:
      return "extreme";
    case Rule::largest:
      return "largest";
    case Rule::least:
      return "least";
    case Rule::any_bit:
      return "any_bit";
  }
  return "";
}

Json grid_json(const GridSpec& spec, std::int64_t factor) {
  return {{"rows", spec.rows},
          {"cols", spec.cols},
          {"resolution_m", spec.resolution_m},
          {"x_m", spec.x(0)},
          {"y_m", spec.y(0)},
          {"factor", factor},
          {"cell_rows", (spec.rows + factor - 1) / factor},
          {"cell_cols", (spec.cols + factor - 1) / factor}};
}

Json footprint_json(const EvaluationParameters& parameters, double resolution_m) {
  return {{"shape", parameters.footprint_shape == FootprintShape::square ? "square" : "disc"},
          {"width_m", parameters.footprint_m},
          {"half_bins", footprint_of(parameters, resolution_m).half_bins()}};
}

/// Sorted by size, the largest first; equal sizes keep their order.
Json holes_json(std::vector<Hole> holes, const GridSpec& spec) {
  std::ranges::stable_sort(holes, [](const Hole& a, const Hole& b) { return a.size_bins > b.size_bins; });
  holes.resize(std::min(holes.size(), kMaxHoles));
  Json list = Json::array();
  for (const Hole& hole : holes)
    list.push_back(
        {{"size_bins", hole.size_bins},
         {"x_m", number(hole.centroid_x_m)},
         {"y_m", number(hole.centroid_y_m)},
         {"width_m", static_cast<double>(hole.north_east.col - hole.south_west.col + 1) * spec.resolution_m},
         {"height_m", static_cast<double>(hole.north_east.row - hole.south_west.row + 1) * spec.resolution_m},
         {"distance_bins", number(hole.largest_distance_bins)}});
  return list;
}

/// Packs layers in parallel, as many at a time as there are threads.
class Packer {
 public:
  explicit Packer(const EvaluationLimits& limits) : limits_(limits) {}

  /// The layer must outlive the packer.
  Json add(const ReportLayer& layer, const std::string& id) {
    ids_.push_back(id);
    codes_.emplace_back(layer.values.codes);
    const std::optional<double> limit_m = limit_of_layer(limits_, layer.name);
    return {{"id", id},
            {"name", layer.name},
            {"title", layer.title},
            {"unit", layer.unit},
            {"style", name_of(layer.style)},
            {"colors", colors_of(layer.style)},
            {"limit_m", limit_m ? Json(*limit_m) : Json(nullptr)},
            {"rule", name_of(layer.rule)},
            {"offset", layer.values.offset},
            {"step", layer.values.step},
            {"low", layer.values.low},
            {"high", layer.values.high}};
  }
  Json keep(ReportLayer layer, const std::string& id) {
    return add(kept_.emplace_back(std::move(layer)), id);
  }

  [[nodiscard]] std::vector<std::pair<std::string, std::string>> pack() const {
    std::vector<std::pair<std::string, std::string>> result(ids_.size());
    parallel_for(ids_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) result[i] = {ids_[i], packed(codes_[i])};
    });
    return result;
  }

 private:
  const EvaluationLimits& limits_;
  std::vector<std::string> ids_;
  std::vector<std::span<const std::uint16_t>> codes_;
  std::deque<ReportLayer> kept_;
};

Json crop_json(const WorstFootprint& f, const std::string& id, Packer& packer) {
  const std::int64_t factor = reduction_factor(f.window, kMaxCropCells);
  const std::string axis(1, f.axis);
  const bool horizontal = f.axis == 'h';
  ReportLayer elevation{"z_est",    "Estimated elevation",
                        "m",        Style::elevation,
                        Rule::mean, quantise(reduce(f.z_est, factor, Rule::mean).cells, kMaxSteps)};
  ReportLayer error{horizontal ? "e_xy" : "e_" + axis,
                    horizontal ? "Horizontal error" : "Error in " + axis,
                    "m",
                    horizontal ? Style::magnitude : Style::signed_error,
                    Rule::extreme,
                    quantise(reduce(f.error, factor, Rule::extreme).cells, kErrorSteps)};
  Json crop = grid_json(f.window, factor);
  crop["layers"] = {packer.keep(std::move(elevation), id + "-z_est"),
                    packer.keep(std::move(error), id + "-error")};
  return crop;
}

Json worst_json(const ReportContent& content, Packer& packer) {
  Json list = Json::array();
  const GridSpec& spec = content.layers.spec();
  for (const WorstFootprint& f : content.worst) {
    const std::string id = "worst-" + std::to_string(list.size() + 1);
    list.push_back(
        {{"x_m", spec.x(f.bin.col)},
         {"y_m", spec.y(f.bin.row)},
         {"requirement", f.requirement},
         {"axis", std::string(1, f.axis)},
         {"share", number(f.share)},
         {"relative_m", {number(f.relative_m[0]), number(f.relative_m[1]), number(f.relative_m[2])}},
         {"absolute_m", {number(f.absolute_m[0]), number(f.absolute_m[1]), number(f.absolute_m[2])}},
         {"horizontal_m", number(f.horizontal_m)},
         {"crop", crop_json(f, id, packer)}});
  }
  return list;
}

Json histograms_json(const ReportLayers& layers) {
  Json result = Json::object();
  const std::pair<const char*, Axis> axes[] = {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}};
  for (const auto& [name, axis] : axes)
    result[name] = {{"error", fields_json(layers.histograms(axis).error)},
                    {"relative", fields_json(layers.histograms(axis).relative)}};
  return result;
}

}  // namespace

ReportData report_data(const ReportContent& content) {
  const ReportLayers& layers = content.layers;
  Packer packer(content.parameters.limits);
  Json list = Json::array();
  for (const ReportLayer& layer : layers.layers()) list.push_back(packer.add(layer, layer.name));
  ReportData data;
  data.values = {{"grid", grid_json(layers.spec(), layers.factor())},
                 {"footprint", footprint_json(content.parameters, layers.spec().resolution_m)},
                 {"limits", fields_json(content.parameters.limits)},
                 {"quantile", content.parameters.quantile},
                 {"colors", colors_json()},
                 {"metrics", metrics_json(content.evaluation.metrics)},
                 {"layers", std::move(list)},
                 {"fail_count", layers.fail_counts()},
                 {"histograms", histograms_json(layers)},
                 {"holes", holes_json(content.evaluation.holes, layers.spec())},
                 {"worst", worst_json(content, packer)}};
  data.packed = packer.pack();
  return data;
}

}  // namespace landfall::html_report
