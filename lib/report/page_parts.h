// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "report/page_data.h"

namespace landfall::html_report {

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

/// A whole page: the template `name` of lib/report/web, put together by python/landfall/web.py, with each
/// @NAME@ replaced by its value in `parts`. All have title, subtitle, banner, provenance and data; others are
/// those that the template's sections name.
[[nodiscard]] std::string page_html(std::string_view name, const std::map<std::string, std::string>& parts);

}  // namespace landfall::html_report
