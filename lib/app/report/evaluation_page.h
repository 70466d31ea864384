// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/report/evaluation_layers.h"
#include "app/report/worst_footprints.h"
#include "chain/evaluation/evaluate.h"
#include "store/files/evaluation_file.h"

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

/// The whole report: one self-contained HTML file, which needs no other files and no network. Equal contents
/// give equal bytes.
[[nodiscard]] std::string report_page(const ReportContent& content);

/// The report on the evaluation of a DEM file. It receives the layers while they are evaluated.
class Report : public ReportLayers {
 public:
  /// `dem` holds the layers of the file; `parameters` must outlive the report. Throws FormatError.
  Report(const std::filesystem::path& path, const DemLayers& dem, std::string crs_wkt,
         const EvaluationParameters& parameters);

  /// The whole page; call it after the evaluation. Without a title it has one of the provenance. Throws
  /// FormatError.
  [[nodiscard]] std::string page(const Evaluation& evaluation, const Provenance& provenance,
                                 const std::string& title = {}) const;

 private:
  const EvaluationParameters& parameters_;
  std::string crs_wkt_;
  DemWindowReader dem_;
};

}  // namespace landfall::html_report
