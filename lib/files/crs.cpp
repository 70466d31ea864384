// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/crs.h"

#include <cstdint>

#include "terrain/relief/dem_raster.h"

namespace landfall {

void write_crs(hid_t root, const std::string& wkt) {
  const h5::Handle crs = h5::create_dataset(root, "crs", h5::Type::int32, {.size = {}, .chunk = {}});
  const std::int32_t zero = 0;
  H5Dwrite(crs.get(), H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, &zero);
  h5::write_attribute(crs.get(), "units", std::string("1"));
  h5::write_attribute(crs.get(), "long_name", std::string("coordinate reference system of the site frame"));
  h5::write_attribute(crs.get(), "crs_wkt", wkt.empty() ? std::string(kLocalSiteCrsWkt) : wkt);
}

std::string read_crs(hid_t root) {
  const h5::Handle crs = h5::open_dataset(root, "crs");
  return crs ? h5::read_text_attribute(crs.get(), "crs_wkt").value_or(kLocalSiteCrsWkt) : kLocalSiteCrsWkt;
}

}  // namespace landfall
