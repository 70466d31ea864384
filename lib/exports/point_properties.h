// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "exports/point_reader.h"
#include "files/contents.h"

namespace landfall {

/// A value of each point in a binary point cloud (.ply, .pcd): a column under the name and type of the
/// format.
struct PointProperty {
  ContentInfo column;
  std::string name;
  h5::Type type;  ///< that is written; int64 becomes double, which both formats have instead
};

/// The properties of a pass, whose first three columns are the position in metres: x, y and z of the type
/// `position`, then the other columns as scalar_NAME of their type in the file. range_measured is named
/// scalar_range_meas because CloudCompare takes a property whose name contains "red" for a colour.
[[nodiscard]] std::vector<PointProperty> point_properties(const PointReader& points,
                                                          const PointReader::Pass& pass, h5::Type position);

/// Encodes the properties of each row one after the other, little-endian.
[[nodiscard]] EncodeRows encoder_of(const std::vector<PointProperty>& properties);

}  // namespace landfall
