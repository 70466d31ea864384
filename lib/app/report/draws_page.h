// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "chain/evaluation/parameters.h"
#include "store/files/draws_file.h"
#include "store/files/provenance.h"

namespace landfall::html_report {

/// The content of a report on a run of draws. All referenced objects must outlive the call.
struct DrawsReport {
  const Draws& draws;
  const nlohmann::ordered_json& verdict;  ///< verdict_json()
  const EvaluationParameters& parameters;
  bool traces = false;  ///< each draw traces its rays
};

inline constexpr std::int64_t kMaxShownDraws =
    5000;  ///< the first ones, in diagrams and the table of failures

/// The whole report on a run of draws: one self-contained HTML file, which needs no other files and no
/// network. Equal contents give equal bytes. Without a title it has one of the provenance.
[[nodiscard]] std::string draws_page(const DrawsReport& content, const Provenance& provenance,
                                     const std::string& title = {});

}  // namespace landfall::html_report
