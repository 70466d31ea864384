// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/crs.h"

#include <cstdint>
#include <optional>

#include "files/grid_mapping.h"
#include "terrain/relief/dem_raster.h"

namespace landfall {

namespace {

void write_attributes(hid_t crs, const GridMapping& mapping) {
  for (const auto& [name, text] : mapping.texts) h5::write_attribute(crs, name, text);
  for (const auto& [name, values] : mapping.numbers) {
    if (values.size() == 1)
      h5::write_attribute(crs, name, values[0]);
    else
      h5::write_attribute(crs, name, h5::Type::float64, {values.at(0), values.at(1)});
  }
}

}  // namespace

CfFrame write_crs(hid_t root, const std::string& wkt) {
  const std::string text = wkt.empty() ? std::string(kLocalSiteCrsWkt) : wkt;
  const h5::Handle crs = h5::create_dataset(root, "crs", h5::Type::int32, {.size = {}, .chunk = {}});
  const std::int32_t zero = 0;
  H5Dwrite(crs.get(), H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, &zero);
  h5::write_attribute(crs.get(), "units", std::string("1"));
  h5::write_attribute(crs.get(), "long_name", std::string("coordinate reference system of the site frame"));
  h5::write_attribute(crs.get(), "crs_wkt", text);
  if (is_local_crs(text)) return CfFrame::local;
  const std::optional<GridMapping> mapping = grid_mapping_of(text);
  if (!mapping) return CfFrame::inexpressible;
  write_attributes(crs.get(), *mapping);
  return CfFrame::mapped;
}

std::string read_crs(hid_t root) {
  const h5::Handle crs = h5::open_dataset(root, "crs");
  return crs ? h5::read_text_attribute(crs.get(), "crs_wkt").value_or(kLocalSiteCrsWkt) : kLocalSiteCrsWkt;
}

}  // namespace landfall
