// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/progress.h"
#include "exports/point_properties.h"
#include "exports/point_reader.h"
#include "output/byte_sink.h"

namespace landfall {

/// The header of a binary PLY of `count` points with these properties, whose units are in comments.
[[nodiscard]] std::string ply_header(const std::vector<PointProperty>& properties, std::size_t count,
                                     const std::string& file_id);

/// Writes the selected points as binary little-endian PLY, positions as double. The first three columns of
/// `pass` are x, y and z in metres.
void write_points_ply(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress = {});

}  // namespace landfall
