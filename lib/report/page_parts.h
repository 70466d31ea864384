// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
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

/// A table of the steps, which are Provenance::as_step(), and their configurations, collapsed. Steps of
/// another structure are shown as far as possible.
[[nodiscard]] std::string provenance_html(const nlohmann::json& steps);

/// The tool of the last step, its version, the file_id of its `output` and of its input `role`.
[[nodiscard]] std::string subtitle_html(const nlohmann::json& steps, const std::string& output,
                                        const std::string& input, const std::string& role);

/// The data in script elements, which the browser does not run.
[[nodiscard]] std::string data_html(const ReportData& data);

/// A whole page (lib/report/assets): page.html about the sections of the template `sections`, with each
/// @NAME@ replaced by its value in `parts`. These are those of both: title, subtitle, banner, subject ("this
/// evaluation"), provenance, data and what the sections name. `programs` are the scripts beside those that
/// all pages have, in the order of their use.
[[nodiscard]] std::string page_html(std::string_view sections, std::map<std::string, std::string> parts,
                                    std::initializer_list<const char*> programs);

}  // namespace landfall::html_report
