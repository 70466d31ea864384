// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "files/landfall_file.h"
#include "terrain/relief/feature_field.h"

namespace landfall {

/// Writes /features: one row per object, in their order; no group if there are no objects.
void write_features(const LandfallFileWriter& file, const std::vector<PlacedFeature>& features);

}  // namespace landfall
