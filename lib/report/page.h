// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "report/report_data.h"

namespace landfall::html_report {

/// The whole report: one HTML file that needs nothing else, neither beside it nor from a network. Equal
/// contents give equal bytes.
[[nodiscard]] std::string report_page(const ReportContent& content);

}  // namespace landfall::html_report
