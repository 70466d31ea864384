// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page_data.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "dictionary/tables/layers.h"
#include "picture/color_map.h"

namespace landfall::html_report {

using Json = nlohmann::ordered_json;

Json Packer::add(const ReportLayer& layer, const std::string& id) {
  ids_.push_back(id);
  codes_.emplace_back(layer.values.codes);
  return layer_json(layer, id);
}

std::vector<std::pair<std::string, std::string>> Packer::pack() const {
  std::vector<std::pair<std::string, std::string>> result(ids_.size());
  parallel_for(ids_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = {ids_[i], packed(codes_[i])};
  });
  return result;
}

Json finite_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

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

Json colors_json() {
  Json maps = Json::object();
  for (std::size_t k = 0; k < kColorMaps; ++k) {
    const auto colors = static_cast<Colors>(k);
    Json anchors = Json::array();
    for (const std::uint32_t rrggbb : color_anchors(colors)) anchors.push_back(rrggbb);
    maps[name_of(colors)] = std::move(anchors);
  }
  return {{"maps", std::move(maps)},
          {"no_value", kNoValueColor},
          {"mark", kMarkColor},
          {"outliers", dictionary::kOutliers},
          {"limit_inside", dictionary::kLimitInside}};
}

Json groups_json(std::string_view page) {
  Json titles = Json::array();
  for (const dictionary::Group& group : dictionary::kGroups)
    if (group.page == page) titles.push_back(group.title);
  return titles;
}

GridSpec window_about(BinIndex bin, std::int64_t half, const GridSpec& map) {
  const BinIndex first{std::max<std::int64_t>(0, bin.row - half), std::max<std::int64_t>(0, bin.col - half)};
  const BinIndex end{std::min(map.rows, bin.row + half + 1), std::min(map.cols, bin.col + half + 1)};
  return {map.resolution_m, map.first_row + first.row, map.first_col + first.col, end.row - first.row,
          end.col - first.col};
}

}  // namespace landfall::html_report
