// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/points/cloud_reader.h"

namespace landfall {

/// The treatment of the units that the columns of a file state.
struct UnitConversion {
  std::array<double, kCloudFieldCount> factors;
  std::vector<std::string> notes;  ///< sentences without the file's name
};

/// Degrees and seconds are always made of other angles and times. Without a CRS, x and y become metres; with
/// one they keep their unit, which must be that of the CRS. z becomes metres unless `vertical_scale` is
/// given, which wins.
[[nodiscard]] UnitConversion unit_conversion(const CloudInfo& info, bool has_crs,
                                             std::optional<double> vertical_scale);

/// A reader whose values are those of `cloud` times the factors.
[[nodiscard]] std::unique_ptr<CloudReader> converted(std::unique_ptr<CloudReader> cloud,
                                                     const UnitConversion& conversion);

}  // namespace landfall
