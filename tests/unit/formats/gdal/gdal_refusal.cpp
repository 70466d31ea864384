// SPDX-License-Identifier: GPL-3.0-or-later
// Prints why load_dem() refuses a raster. Run by gdal_plugin_test.cpp, in processes with different plugins.
#include <iostream>

#include "base/core/error.h"
#include "formats/gdal/gdal_loader.h"

int main() {
  landfall::DemBase dem;
  dem.path = "any.tif";
  try {
    (void)load_dem(dem, landfall::GridSpec::centered(1, 1));
  } catch (const landfall::FormatError& error) {
    std::cout << error.what();
    return 0;
  }
  return 1;
}
