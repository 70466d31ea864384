// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "app/report/page_parts.h"
#include "chain/hazards/hazard_map.h"
#include "store/files/provenance.h"

namespace landfall::html_report {

/// The content of a report on a hazard map. All referenced objects must outlive the call.
struct HazardReport {
  const HazardInput& input;  ///< as map_hazards() judged it
  const HazardParameters& parameters;
  const HazardMap& map;
  std::optional<double> truth_spacing_m = std::nullopt;  ///< DemLayers::truth_spacing_m
};

inline constexpr std::size_t kMaxDrawnSites = 10;  ///< the best ones, with their poses

/// The data of the page's scripts: layers, sites with their poses, and the score. `elevation` is the name of
/// the elevations' dataset. Maps of more than `max_cells` bins along an axis are reduced to at most that
/// number.
[[nodiscard]] ReportData hazard_data(const HazardReport& content, const std::string& elevation,
                                     std::int64_t max_cells = kMaxCells);

/// The judged region of EvaluationParameters; that of HazardParameters has no half width.
[[nodiscard]] nlohmann::ordered_json region_json(RegionShape shape, double radius_m, Horizontal center_m,
                                                 double half_width_m = 0);

/// The border of the reachable places: [[x, y], ...], open.
[[nodiscard]] nlohmann::ordered_json outline_json(const ReachableArea& area);

/// The whole report on a hazard map: one self-contained HTML file, which needs no other files and no network.
/// Equal contents give equal bytes. The first input of the provenance is the judged map. Without a title it
/// has one of the provenance.
[[nodiscard]] std::string hazard_page(const HazardReport& content, const Provenance& provenance,
                                      const std::string& title = {});

}  // namespace landfall::html_report
