// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "raster/grid_spec.h"
#include "report/report_layer.h"

namespace landfall::html_report {

/// The data that a page's scripts draw: plain values, and separately the packed() texts by name.
struct ReportData {
  nlohmann::ordered_json values;
  std::vector<std::pair<std::string, std::string>> packed;
};

/// Packs layers in parallel, as many at a time as there are threads.
class Packer {
 public:
  /// layer_json(). The layer must outlive the packer.
  nlohmann::ordered_json add(const ReportLayer& layer, const std::string& id);
  nlohmann::ordered_json keep(ReportLayer layer, const std::string& id) {
    return add(kept_.emplace_back(std::move(layer)), id);
  }

  [[nodiscard]] std::vector<std::pair<std::string, std::string>> pack() const;

 private:
  std::vector<std::string> ids_;
  std::vector<std::span<const std::uint16_t>> codes_;
  std::deque<ReportLayer> kept_;
};

/// Maps of more bins along an axis are reduced to at most that number.
inline constexpr std::int64_t kMaxCells = 1024;
inline constexpr std::int64_t kMaxCropCells = 512;  ///< of the surroundings of a place

/// Null for a number that is not finite.
[[nodiscard]] nlohmann::ordered_json finite_json(double value);
/// A map's bins and its blocks of factor x factor bins.
[[nodiscard]] nlohmann::ordered_json grid_json(const GridSpec& spec, std::int64_t factor);
/// The colour maps of lib/picture, which the page's scripts use too.
[[nodiscard]] nlohmann::ordered_json colors_json();

/// The headings of the groups of maps of a page ("evaluation", "hazards", "draws"), in their order.
[[nodiscard]] nlohmann::ordered_json groups_json(std::string_view page);
/// The bins of `map` within `half` of the bin along either axis.
[[nodiscard]] GridSpec window_about(BinIndex bin, std::int64_t half, const GridSpec& map);

}  // namespace landfall::html_report
