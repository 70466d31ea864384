// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "evaluation/evaluate.h"
#include "report/page_data.h"
#include "report/report_layers.h"
#include "report/worst_footprints.h"

namespace landfall::html_report {

/// The content of a report. All referenced objects must outlive the call.
struct ReportContent {
  const EvaluationParameters& parameters;
  const Evaluation& evaluation;
  const ReportLayers& layers;
  const std::vector<WorstFootprint>& worst;
  /// The steps up to the evaluation, oldest first, the evaluation last: Provenance::as_step(). Not empty.
  const nlohmann::json& steps;
  std::string title = {};    ///< the user's; if empty, the page makes one of the steps
  std::string crs_wkt = {};  ///< the frame of the DEM
};

[[nodiscard]] ReportData report_data(const ReportContent& content);

}  // namespace landfall::html_report
