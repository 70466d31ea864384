// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/raster_screening.h"

#include <filesystem>
#include <string>

#include "hdf5/file_screening.h"
#include "hdf5/h5.h"
#include "terrain/gdal/gdal_loader.h"

namespace landfall {

void screen_raster(const DemBase& dem, RasterLinks links) {
  h5::initialise();
  for (const std::string& name : named_dem_files(dem, links)) {
    std::error_code unreachable;
    if (!std::filesystem::is_regular_file(name, unreachable)) continue;
    h5::MetadataGuard guard(name);
    if (const h5::Handle file = h5::open_for_its_kind(name)) h5::screen_file(file.get(), name, guard);
  }
}

}  // namespace landfall
