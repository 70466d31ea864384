// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/report/report_layer.h"
#include "base/raster/grid_spec.h"

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

/// A map's bins and its blocks of factor x factor bins.
[[nodiscard]] nlohmann::ordered_json grid_json(const GridSpec& spec, std::int64_t factor);
/// The colour maps of lib/formats/picture, which the page's scripts use too.
[[nodiscard]] nlohmann::ordered_json colors_json();

/// The headings of the groups of maps of a page ("evaluation", "hazards", "draws"), in their order.
[[nodiscard]] nlohmann::ordered_json groups_json(std::string_view page);
/// The bins of `map` within `half` of the bin along either axis.
[[nodiscard]] GridSpec window_about(BinIndex bin, std::int64_t half, const GridSpec& map);

/// The first member of an object with this key; null if there is none, or if `object` is not an object.
[[nodiscard]] nlohmann::json member(const nlohmann::json& object, const char* key);
/// The member as escaped text; a dash if there is none.
[[nodiscard]] std::string text_of(const nlohmann::json& object, const char* key);

/// Probabilities near 1 need their last digits: "0.9987".
[[nodiscard]] std::string probability_text(double p);

/// The section on what led to `what`, "this scan": a table of the steps, which are Provenance::as_step(), and
/// their configurations, collapsed. Steps of another structure are shown as far as possible.
[[nodiscard]] std::string provenance_html(const nlohmann::json& steps, const std::string& what);

/// A paragraph: the tool of the last step, its version, the file_id of its `output` and of its input `role`.
[[nodiscard]] std::string subtitle_html(const nlohmann::json& steps, const std::string& output,
                                        const std::string& input, const std::string& role);

/// The data in script elements, which the browser does not run.
[[nodiscard]] std::string data_html(const ReportData& data);

/// A whole page: the template `name` of lib/app/report/web, put together by python/landfall/web.py, with each
/// @NAME@ replaced by its value in `parts`. All have title, subtitle, banner, provenance and data; others are
/// those that the template's sections name.
[[nodiscard]] std::string page_html(std::string_view name, const std::map<std::string, std::string>& parts);

}  // namespace landfall::html_report
