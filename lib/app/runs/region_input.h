// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "store/config/region_config.h"
#include "store/files/meeting.h"
#include "store/files/provenance.h"

namespace landfall {

/// The map on which a region is judged.
struct RegionMap {
  std::string name;  ///< for messages
  const GridSpec& grid;
  const std::string& crs_wkt;
  bool is_clipped = false;  ///< whether a polygon may reach beyond the map
  MeetingRules rules = {};
  std::function<void(const std::string&)> warn = {};  ///< gets the assumptions about a file
};

/// The bins of a region that is a mask or polygons; nothing for other shapes. A file is added to the
/// provenance; assumptions are in `assumed` of its input.
///
/// Throws FormatError and UsageError as read_region_mask(), polygon_file() and polygon_region() do; `name`
/// begins a message about vertices of the configuration.
[[nodiscard]] std::optional<BinMask> read_region(const RegionConfig& region, const RegionMap& map,
                                                 const std::string& name, Provenance& provenance);

}  // namespace landfall
