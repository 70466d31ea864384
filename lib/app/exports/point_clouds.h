// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/exports/point_reader.h"
#include "base/core/progress.h"
#include "base/output/byte_sink.h"
#include "store/files/contents.h"

namespace landfall {

/// A value of each point in a binary point cloud (.ply, .pcd): a column under the name and type of the
/// format.
struct PointProperty {
  ContentInfo column;
  std::string name;
  h5::Type type;  ///< that is written; int64 becomes double, which both formats have instead
};

/// The header of a binary PLY of `count` points with these properties, whose units are in comments, with the
/// CRS of the map on which they lie.
[[nodiscard]] std::string ply_header(const std::vector<PointProperty>& properties, std::size_t count,
                                     const std::string& file_id, const std::optional<MapFrame>& map = {});

/// Writes the selected points as binary little-endian PLY, positions as double. The first three columns of
/// `pass` are x, y and z.
void write_points_ply(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress = {});

/// The offset of positions on a map: the site's centre.
[[nodiscard]] std::array<double, 3> pcd_offset(const std::optional<MapFrame>& map);

/// The header of a binary PCD 0.7 of `count` points with these properties, whose units are in comments. The
/// translation of VIEWPOINT is pcd_offset().
[[nodiscard]] std::string pcd_header(const std::vector<PointProperty>& properties, std::size_t count,
                                     const std::string& file_id, const std::optional<MapFrame>& map = {});

/// Writes the selected points as binary PCD. The first three columns of `pass` are x, y and z; they are
/// float32, the only type with which the Point Cloud Library finds a position (D417), from pcd_offset().
/// Returns the largest error of this rounding, in the unit of the positions.
double write_points_pcd(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                        const ProgressCallback& progress = {});

}  // namespace landfall
