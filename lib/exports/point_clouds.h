// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/progress.h"
#include "exports/point_reader.h"
#include "files/contents.h"
#include "output/byte_sink.h"

namespace landfall {

/// A value of each point in a binary point cloud (.ply, .pcd): a column under the name and type of the
/// format.
struct PointProperty {
  ContentInfo column;
  std::string name;
  h5::Type type;  ///< that is written; int64 becomes double, which both formats have instead
};

/// The header of a binary PLY of `count` points with these properties, whose units are in comments.
[[nodiscard]] std::string ply_header(const std::vector<PointProperty>& properties, std::size_t count,
                                     const std::string& file_id);

/// Writes the selected points as binary little-endian PLY, positions as double. The first three columns of
/// `pass` are x, y and z in metres.
void write_points_ply(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress = {});

/// The header of a binary PCD 0.7 of `count` points with these properties, whose units are in comments.
[[nodiscard]] std::string pcd_header(const std::vector<PointProperty>& properties, std::size_t count,
                                     const std::string& file_id);

/// Writes the selected points as binary PCD. The first three columns of `pass` are x, y and z in metres; they
/// are float32, the only type with which the Point Cloud Library finds a position (D417). Returns the largest
/// error of this rounding, metres.
double write_points_pcd(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                        const ProgressCallback& progress = {});

}  // namespace landfall
