// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/core/progress.h"
#include "base/raster/grid_spec.h"
#include "chain/terrain/site_point.h"
#include "store/files/grid_file.h"
#include "store/files/landfall_file.h"
#include "store/files/meeting.h"
#include "store/files/scan_file.h"

namespace landfall {

/// The bin of a dem.h5 that holds a point: its centre, in the frame of the site and on the map of a site that
/// has a CRS, and the value of each layer, null where it has none.
/// With the scan that it was made from, also each return in the bin: pulse, pixel, time since the first
/// pulse, status, ranges, weight, z_est, and the share of its weight in the bin's sum (null for a method
/// without weights). Throws UsageError for a point off the map, FormatError for a scan that the DEM was not
/// made from.
[[nodiscard]] nlohmann::ordered_json describe_bin(const std::filesystem::path& dem, const SitePoint& point,
                                                  const std::optional<std::filesystem::path>& scan,
                                                  const ProgressCallback& progress = {});

/// The bin of a map that holds a point. Throws UsageError, which names the file `name` and the extent of the
/// map, for a point off it.
[[nodiscard]] BinIndex bin_on_map(const GridSpec& spec, const SitePoint& point, const std::string& name);

/// The file, the centre of a bin in the frame of the site and on the map, its indices and its width.
[[nodiscard]] nlohmann::ordered_json place_of_bin(const std::filesystem::path& path,
                                                  const GridLayerReader& grid, BinIndex bin);

/// The file_ids of the inputs with a role ("scan", "dem") of one of the steps that led to a file, or of
/// itself.
[[nodiscard]] std::vector<std::string> inputs_of(const LandfallFileReader& made, const std::string& step,
                                                 const std::string& role);

/// How the coordinates of a scan became those of the DEM, one of the steps that led to `made`, whose frame is
/// the DEM's. Throws FormatError unless the DEM was made from the scan.
[[nodiscard]] Placement placement_in_dem(const LandfallFileReader& made, const std::string& crs_wkt,
                                         const std::string& dem, const ScanReader& scan);

/// Throws FormatError unless `source` is one of the inputs by its file_id.
void require_input(const LandfallFileReader& made, const std::vector<std::string>& inputs,
                   const LandfallFileReader& source);

}  // namespace landfall
