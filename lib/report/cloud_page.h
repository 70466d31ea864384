// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "report/cloud_data.h"

namespace landfall::html_report {

/// A page that shows points of a scan: one self-contained HTML file, which needs no other files and no
/// network. Equal contents give equal bytes. `steps`: the scan's chain of provenance, itself last
/// (LandfallFileReader::chain).
[[nodiscard]] std::string cloud_page(const CloudContent& content, const nlohmann::json& steps);

}  // namespace landfall::html_report
