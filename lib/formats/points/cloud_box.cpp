// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/cloud_box.h"

#include <algorithm>
#include <cmath>

#include "base/core/error.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

bool all_of_box(const CloudBox& box, bool (*holds)(double)) {
  return std::ranges::all_of(box.low, holds) && std::ranges::all_of(box.high, holds);
}

std::string range_text(const CloudBox& box, std::size_t axis) {
  return "[" + number_text(box.low[axis]) + ", " + number_text(box.high[axis]) + "]";
}

}  // namespace

std::string compare_with_box(const std::string& name, const CloudBox& declared, const CloudBox& points,
                             const CloudSteps& steps) {
  if (all_of_box(declared, [](double value) { return value == 0; }))
    return "the extent in its header is all zero, so that its points cannot be checked against it";
  if (!all_of_box(declared, [](double value) { return std::isfinite(value); }))
    return "the extent in its header is not finite, so that its points cannot be checked against it";
  double longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    longest = std::max(longest, declared.high[axis] - declared.low[axis]);
  std::string warning;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double beyond =
        std::max(declared.low[axis] - points.low[axis], points.high[axis] - declared.high[axis]);
    const double step = 1.001 * std::abs(steps.scale[axis]);  // coordinates are rounded
    const std::string what = std::string("its points are in ") + "xyz"[axis] + " in " +
                             range_text(points, axis) + ", but its header declares " +
                             range_text(declared, axis);
    if (beyond > std::max(longest / 100, step))
      throw FormatError(
          name + ": " + what +
          ": its header or its points are damaged; write it again with the program that made it");
    if (beyond > 2 * step && warning.empty()) warning = what;
  }
  return warning;
}

}  // namespace landfall
