// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "raster/grid_spec.h"
#include "terrain/dem_raster.h"
#include "terrain/terrain_model.h"

namespace landfall {

/// What the plugin gives to its loader. Both sides are of one build: `version` guards against a stale file.
struct GdalPlugin {
  const char* version;
  DemRaster (*read_dem)(const DemBase& dem, const GridSpec& site);
};

/// The name of the plugin's one object, of type GdalPlugin.
inline constexpr const char* kGdalPluginSymbol = "landfall_gdal_plugin";

}  // namespace landfall
