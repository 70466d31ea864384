// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/report/page_parts.h"
#include "base/raster/grid.h"
#include "store/files/contents.h"

namespace landfall::html_report {

/// The report on a comparison of two files: the answer in words, the statistics, and the main layers of both
/// and their difference.
class ComparisonReport {
 public:
  /// A layer of both files on their common bins (ComparisonRequest::on_layer). Layers that no page shows are
  /// ignored.
  void take(const std::string& kind, const ContentInfo& layer, const Grid<double>& a, const Grid<double>& b);

  /// The whole page: one self-contained HTML file, which needs no other files and no network. `comparison`
  /// is the result of compare_files(). Equal files under equal names give equal bytes.
  [[nodiscard]] std::string page(const nlohmann::ordered_json& comparison) const;

 private:
  std::vector<ReportLayer> layers_;
  std::vector<std::string> titles_;  ///< one for each three layers
  std::optional<GridSpec> grid_;
};

}  // namespace landfall::html_report
