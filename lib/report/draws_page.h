// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "files/provenance.h"
#include "report/draws_data.h"

namespace landfall::html_report {

/// The whole report on a campaign: one self-contained HTML file, which needs no other files and no network.
/// Equal contents give equal bytes. Without a title it has one of the provenance.
[[nodiscard]] std::string draws_page(const DrawsReport& content, const Provenance& provenance,
                                     const std::string& title = {});

}  // namespace landfall::html_report
