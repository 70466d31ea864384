// SPDX-License-Identifier: GPL-3.0-or-later
// A report names no file and no time, only file_ids: equal evaluations give equal bytes, whatever the name
// of the DEM.
#include "report/page.h"

#include <utility>

#include "report/escape.h"
#include "report/heading.h"
#include "report/page_parts.h"
#include "report/verdicts.h"

namespace landfall::html_report {

std::string report_page(const ReportContent& content) {
  const Metrics& metrics = content.evaluation.metrics;
  const std::string title = content.title.empty() ? title_of(content.steps) : content.title;
  return page_html("evaluation.html", {{"title", html_text(title)},
                                       {"subtitle", subtitle_html(content.steps, "evaluation", "DEM", "dem")},
                                       {"banner", verdict_banner_html(metrics)},
                                       {"verdicts", verdict_table_html(metrics, content.parameters.limits)},
                                       {"provenance", provenance_html(content.steps)},
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
