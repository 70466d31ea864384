// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "files/landfall_file.h"
#include "terrain/relief/feature_field.h"

namespace landfall {

/// A row of /features: what the list of objects of a terrain says of one.
struct FeatureRecord {
  std::string kind;  ///< the kName of its shape
  double x_m = 0;    ///< of its centre, frame D
  double y_m = 0;
  double ground_m = 0;  ///< elevation of the ground under its centre; NaN off the grid and on a hole
  FeatureSize size;
  std::int32_t pattern = -1;
  std::int64_t number = 0;
};

/// Writes /features: one row per object, in their order; no group where there are none.
void write_features(const LandfallFileWriter& file, const std::vector<PlacedFeature>& features);

/// The rows of /features; none where there is no such group. Throws FormatError, naming the column, where one
/// is missing, has another length than the others, or says a kind that its flag_meanings do not; also above
/// 10^8 rows.
[[nodiscard]] std::vector<FeatureRecord> read_features(const LandfallFileReader& file);

}  // namespace landfall
