// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "evaluation/parameters.h"
#include "files/draws_file.h"
#include "report/page_data.h"

namespace landfall::html_report {

/// The content of a report on a campaign. All referenced objects must outlive the call.
struct DrawsReport {
  const Draws& draws;
  const nlohmann::ordered_json& verdict;  ///< verdict_json()
  const EvaluationParameters& parameters;
  bool traces = false;  ///< each draw traces its rays
};

inline constexpr std::int64_t kMaxShownDraws =
    5000;  ///< the first ones, in diagrams and the table of failures

/// The data of the page's scripts: maps, if the campaign has any, and the numbers of each draw. `config` is
/// the campaign's configuration. Maps of more than `max_cells` bins along an axis are reduced to at most
/// that number.
[[nodiscard]] ReportData draws_data(const DrawsReport& content, const nlohmann::json& config,
                                    std::int64_t max_cells = kMaxCells);

}  // namespace landfall::html_report
