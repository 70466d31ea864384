// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/crs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "files/grid_mapping.h"
#include "terrain/relief/dem_raster.h"

namespace landfall {

namespace {

/// Equal parameters of two projections but for the rounding of texts.
bool are_near(const std::pair<std::string, std::vector<double>>& a,
              const std::pair<std::string, std::vector<double>>& b) {
  return a.first == b.first && std::ranges::equal(a.second, b.second, [](double p, double q) {
           return std::abs(p - q) <= 1e-9 + 1e-10 * std::abs(p);
         });
}

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

bool may_be_one_frame(const std::string& a, const std::string& b) {
  if (a == b || a.empty() || b.empty() || is_local_crs(a) || is_local_crs(b)) return true;
  const std::optional<GridMapping> first = grid_mapping_of(a);
  const std::optional<GridMapping> second = grid_mapping_of(b);
  return first && second && first->texts.front() == second->texts.front() &&
         std::ranges::equal(first->numbers, second->numbers, are_near);
}

std::string read_crs(hid_t root) {
  const h5::Handle crs = h5::open_dataset(root, "crs");
  return crs ? h5::read_text_attribute(crs.get(), "crs_wkt").value_or(kLocalSiteCrsWkt) : kLocalSiteCrsWkt;
}

}  // namespace landfall
