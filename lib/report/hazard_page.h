// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "files/provenance.h"
#include "report/hazard_data.h"

namespace landfall::html_report {

/// The whole report on a hazard map: one self-contained HTML file, which needs no other files and no network.
/// Equal contents give equal bytes. The first input of the provenance is the judged map. Without a title it
/// has one of the provenance.
[[nodiscard]] std::string hazard_page(const HazardReport& content, const Provenance& provenance,
                                      const std::string& title = {});

}  // namespace landfall::html_report
