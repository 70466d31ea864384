// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "formats/points/cloud_reader.h"

namespace landfall {

/// Compares the extent of the points of a file with the box that it declares; `name` begins the message.
/// Returns a warning without the name, or an empty text.
///
/// Throws FormatError, naming both ranges, where the points leave the box by more than 1 % of its longest
/// edge and by more than one step of their coordinates: scale, offset or points are damaged. Warns where they
/// leave it by more than two steps, which programs that round the box do, and of a box that is all zero or
/// not finite.
[[nodiscard]] std::string compare_with_box(const std::string& name, const CloudBox& declared,
                                           const CloudBox& points, const CloudSteps& steps);

}  // namespace landfall
