// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "evaluation/metrics.h"

namespace landfall::html_report {

/// The table of requirements as HTML: requirement, what is measured, value, limit, margin, verdict. Fractions
/// are shown in percent, all numbers with up to 6 significant digits. The margin is the distance of the value
/// from its limit, negative if the requirement is missed.
[[nodiscard]] std::string verdict_table_html(const Metrics& metrics);

/// The verdict on all requirements, as an element of class "banner".
[[nodiscard]] std::string verdict_banner_html(const Metrics& metrics);

}  // namespace landfall::html_report
