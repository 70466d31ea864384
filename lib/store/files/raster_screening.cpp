// SPDX-License-Identifier: GPL-3.0-or-later
// An output is compared with every file that an input leads to: also those that a VRT names at any depth,
// those inside a name such as `NETCDF:"f.h5":z` or `/vsizip/f.zip/a.tif`, and those that GDAL lists for a
// raster. GDAL lists a raster's files only if there is a file to replace. Sources of a VRT are
// searched for where they may be opened (lib/formats/gdal/file_guard.h); otherwise the run is refused
// before it writes.
#include "store/files/raster_screening.h"

#include <filesystem>
#include <string>

#include "base/text/file_path.h"
#include "formats/gdal/gdal_loader.h"
#include "store/hdf5/guard/file_screening.h"
#include "store/hdf5/h5.h"

namespace landfall {

void screen_raster(const DemBase& dem, RasterLinks links) {
  h5::initialise();
  for (const std::string& name : named_dem_files(dem, links)) {
    if (!std::filesystem::is_regular_file(status_of(name))) continue;
    h5::MetadataGuard guard(name);
    if (const h5::Handle file = h5::open_for_its_kind(name)) h5::screen_file(file.get(), name, guard);
  }
}

}  // namespace landfall
