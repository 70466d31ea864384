// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/progress.h"
#include "exports/point_reader.h"
#include "output/byte_sink.h"

namespace landfall {

/// The header of a binary PLY of `count` points: x, y and z as double, the other columns as properties
/// scalar_NAME of their type in the file; their units are in comments. range_measured is named
/// scalar_range_meas because CloudCompare takes a property whose name contains "red" for a colour.
[[nodiscard]] std::string ply_header(const std::vector<ContentInfo>& columns, std::size_t count,
                                     const std::string& file_id);

/// Writes the selected points as binary little-endian PLY. The first three columns of `pass` are x, y and z
/// in metres.
void write_points_ply(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress = {});

}  // namespace landfall
