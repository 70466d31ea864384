// SPDX-License-Identifier: GPL-3.0-or-later
// The plugin that an upgrade finds which left the old one behind.
#include "formats/gdal/plugin.h"

extern "C" const landfall::GdalPlugin landfall_gdal_plugin;
const landfall::GdalPlugin landfall_gdal_plugin = [] {
  landfall::GdalPlugin plugin{};
  plugin.version = "0.0.0";
  return plugin;
}();
