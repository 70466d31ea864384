// SPDX-License-Identifier: GPL-3.0-or-later
#include "steering.h"

namespace landfall {

// A unit of its own, because Eigen's shortest turn takes a compiler some 5 s: it holds a singular value
// decomposition.
double image_rotation(const Scanner& scanner, const ScannerState& state) {
  const Eigen::Vector3d x = beam_of(scanner, state, Eigen::Vector3d::UnitX()).direction.v;
  const auto shortest =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), line_of_sight(scanner, state));
  const Eigen::Vector3d untilted = shortest.inverse() * x;
  return std::atan2(untilted.y(), untilted.x());
}

}  // namespace landfall
