// SPDX-License-Identifier: GPL-3.0-or-later
// What an upgrade that left the old plugin behind would find.
#include "terrain/gdal/plugin.h"

extern "C" const landfall::GdalPlugin landfall_gdal_plugin;
const landfall::GdalPlugin landfall_gdal_plugin{"0.0.0", nullptr, nullptr, nullptr,
                                                nullptr, nullptr, nullptr};
