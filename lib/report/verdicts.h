// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "evaluation/metrics.h"

namespace landfall::html_report {

/// The table of requirements as HTML: requirement, what is measured, value, limit, margin, verdict. Fractions
/// are shown in percent, all numbers with up to 6 significant digits; the margin is how far the value is on
/// the right side of its limit, negative where it is not.
[[nodiscard]] std::string verdict_table_html(const Metrics& metrics);

/// The verdict on all of them, as an element of class "banner".
[[nodiscard]] std::string verdict_banner_html(const Metrics& metrics);

}  // namespace landfall::html_report
