// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/runs/cloud_import.h"
#include "base/raster/grid_spec.h"
#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/terrain_model.h"
#include "store/files/meeting.h"

namespace landfall {

/// A raster to import as a DEM, and its truth, if any: a raster or a terrain.h5, not both.
struct RasterImport {
  DemBase dem;          ///< `center`: the origin, moved to the nearest pixel centre
  std::string truth{};  ///< a raster
  std::string terrain{};
  MeetingRules rules = {};
  RasterLinks links = RasterLinks::refused;
};

struct ImportedDem {
  GridSpec grid;
  std::array<double, 2> center{};
  std::int64_t empty_bins = 0;
  std::optional<std::int64_t> bins_with_truth{};
  std::vector<std::string> warnings{};
};

/// Writes a raster as a dem.h5 on its own grid: z_est from its pixels, count 1 where it has a value, z_true
/// from a raster, bilinear and if needed reprojected, or from a terrain at the bins' centres. Throws
/// UsageError for pixels that are not square and north up, with the command that makes them so, FormatError
/// for a truth that has no value at any bin of the DEM with one.
ImportedDem import_raster(const RasterImport& import, ImportOutput output);

}  // namespace landfall
