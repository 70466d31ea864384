// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "files/landfall_file.h"
#include "terrain/relief/feature_field.h"

namespace landfall {

/// A row of /features: one object of a terrain's list.
struct FeatureRecord {
  std::string kind;  ///< the kName of its shape
  double x_m = 0;    ///< of its centre, in frame D
  double y_m = 0;
  double ground_m = 0;  ///< elevation of the ground under its centre; NaN off the grid and on a hole
  FeatureSize size;
  std::int32_t pattern = -1;
  std::int64_t number = 0;
};

/// Writes /features: one row per object, in their order; no group if there are no objects.
void write_features(const LandfallFileWriter& file, const std::vector<PlacedFeature>& features);

/// The rows of /features; empty if there is no such group. Throws FormatError, naming the column, if one is
/// missing, has another length than the others, or contains a kind that its flag_meanings do not define; also
/// for more than 10^8 rows.
[[nodiscard]] std::vector<FeatureRecord> read_features(const LandfallFileReader& file);

}  // namespace landfall
