// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include "base/core/progress.h"
#include "base/output/output_path.h"

namespace landfall {

inline constexpr std::size_t kMaxCloudPoints = 1'000'000;

/// Writes a page that shows the returns of a scan in a browser (app/report/cloud_page.h), at most
/// `max_points` of them, in 1..kMaxCloudPoints, thinned by a grid. Throws FormatError for a scan without a
/// return and as PointReader does.
void write_cloud_page(const std::string& scan, const OutputOptions& output, std::size_t max_points,
                      const ProgressCallback& progress = {});

}  // namespace landfall
