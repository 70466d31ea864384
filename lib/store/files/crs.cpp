// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/crs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/site_wkt.h"
#include "store/files/grid_mapping.h"

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

/// The numbers of a configuration's list; empty unless it is one of numbers.
std::vector<double> numbers_of(const nlohmann::json& config, const char* key) {
  std::vector<double> numbers;
  const nlohmann::json list = config.is_object() ? config.value(key, nlohmann::json()) : nlohmann::json();
  if (!list.is_array()) return numbers;
  for (const nlohmann::json& number : list)
    if (number.is_number()) numbers.push_back(number.get<double>());
  return numbers;
}

double number_of(const nlohmann::json& config, const char* key, double otherwise) {
  const auto found = config.find(key);
  return found != config.end() && found->is_number() ? found->get<double>() : otherwise;
}

/// The centre of an import, whose heights are above its third number times their unit.
std::optional<MapPlace> place_of_import(const nlohmann::json& config) {
  const std::vector<double> center = numbers_of(config, "center");
  if (center.size() < 2) return std::nullopt;
  MapPlace place{.center = {center[0], center[1], 0}, .metres_per_unit = 1, .vertical = {}, .map_wkt = {}};
  if (center.size() > 2) place.center[2] = center[2] * number_of(config, "vertical_scale", 1);
  return place;
}

/// The centre of the first raster of a terrain: NaN where it was not recorded, as the height that became 0.
std::optional<MapPlace> place_of_terrain(const nlohmann::json& config) {
  const nlohmann::json base = config.value("base", nlohmann::json());
  const nlohmann::json bases = base.is_array() ? base : nlohmann::json::array({base});
  for (const nlohmann::json& raster : bases) {
    if (!raster.is_object() || raster.value("type", nlohmann::json()) != "dem") continue;
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> center = numbers_of(raster, "center");
    if (center.size() != 2) center = {kUnknown, kUnknown};
    const bool keeps_heights = raster.value("datum", nlohmann::json()) == "none";
    return MapPlace{.center = {center[0], center[1], keeps_heights ? 0 : kUnknown},
                    .metres_per_unit = number_of(raster, "horizontal_scale_m", 1),
                    .vertical = {},
                    .map_wkt = {}};
  }
  return std::nullopt;
}

std::optional<MapPlace> recorded_place(const nlohmann::json& chain) {
  for (const nlohmann::json& step : chain) {
    const std::string tool = step.value("tool", "");
    const nlohmann::json config = step.value("config", nlohmann::json());
    if (!config.is_object()) continue;
    if (tool == "landfall-import") return place_of_import(config);
    if (tool == "terrain-gen") return place_of_terrain(config);
  }
  return std::nullopt;
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

bool is_one_frame(const std::string& a, const std::string& b) {
  const std::optional<GridMapping> first = grid_mapping_of(a);
  const std::optional<GridMapping> second = grid_mapping_of(b);
  return first && second && first->texts.front() == second->texts.front() &&
         std::ranges::equal(first->numbers, second->numbers, are_near);
}

std::string read_crs(const LandfallFileReader& file) {
  const h5::Handle crs = h5::open_dataset(file.root(), "crs");
  const std::string wkt =
      crs ? h5::read_text_attribute(crs.get(), "crs_wkt").value_or(kLocalSiteCrsWkt) : kLocalSiteCrsWkt;
  if (place_of(wkt) || !is_local_crs(wkt)) return wkt;
  const std::optional<MapPlace> place = recorded_place(file.chain());
  return place ? with_place(wkt, *place) : wkt;
}

}  // namespace landfall
