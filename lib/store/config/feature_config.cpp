// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/feature_config.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <stdexcept>

#include "store/config/json_values.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// The number of an optional key, or `otherwise`.
double number_or(const Json& json, const char* key, double otherwise) {
  return json.contains(key) ? number(json, key) : otherwise;
}

/// A kind of feature by its "type". To add one: its class (lib/chain/terrain/features), a maker and an entry
/// here, and two definitions in schemas/terrain.schema.json.
struct ShapeMaker {
  const char* type;
  FeatureShape (*make)(const Json& json);
};

FeatureShape make_cone(const Json& json) { return Cone{number(json, "radius_m"), number(json, "height_m")}; }

FeatureShape make_hemisphere(const Json& json) { return Hemisphere{number(json, "radius_m")}; }

FeatureShape make_pyramid(const Json& json) {
  return Pyramid{number(json, "base_width_m"), number(json, "height_m"), radians(json, "yaw_deg")};
}

FeatureShape make_rock(const Json& json) {
  const double diameter_m = number(json, "diameter_m");
  return Rock{diameter_m, number_or(json, "height_m", diameter_m / 2), number(json, "axis_ratio"),
              radians(json, "yaw_deg")};
}

FeatureShape make_crater(const Json& json) {
  return Crater{number(json, "diameter_m"), number_or(json, "depth_m", 0), number(json, "freshness")};
}

FeatureShape make_ice_block(const Json& json) {
  return IceBlock{number(json, "length_m"), number(json, "width_m"), number(json, "height_m"),
                  radians(json, "yaw_deg"), radians(json, "tilt_deg")};
}

FeatureShape make_ridge(const Json& json) {
  const double length_m = number(json, "length_m");
  return Ridge{length_m,
               number(json, "width_m"),
               number(json, "height_m"),
               number(json, "spacing_m"),
               number_or(json, "taper_m", length_m / 10),
               radians(json, "yaw_deg")};
}

FeatureShape make_fracture(const Json& json) {
  const double length_m = number(json, "length_m");
  return Fracture{length_m,
                  number(json, "width_m"),
                  number(json, "depth_m"),
                  number(json, "throw_m"),
                  number_or(json, "fade_m", length_m / 2),
                  radians(json, "wall_slope_deg"),
                  number_or(json, "taper_m", length_m / 10),
                  radians(json, "yaw_deg")};
}

FeatureShape make_pit(const Json& json) {
  return Pit{number(json, "diameter_m"), number(json, "depth_m"), radians(json, "wall_slope_deg")};
}

FeatureShape make_penitente_field(const Json& json) {
  PenitenteField field;
  field.length_m = number_or(json, "length_m", 0);
  field.width_m = number_or(json, "width_m", 0);
  field.diameter_m = number_or(json, "diameter_m", 0);
  field.amplitude_m = number(json, "amplitude_m");
  field.wavelength_m = number(json, "wavelength_m");
  field.exponent = number(json, "exponent");
  const double min_m = field.diameter_m > 0 ? field.diameter_m : std::min(field.length_m, field.width_m);
  field.edge_m = number_or(json, "edge_m", std::min(field.wavelength_m, min_m / 2));
  field.yaw_rad = radians(json, "yaw_deg");
  field.wobble_m = number(json, "wobble_m");
  field.wobble_length_m = number_or(json, "wobble_length_m", 2 * field.wavelength_m);
  field.seed = json.at("seed").get<std::uint64_t>();
  return field;
}

constexpr ShapeMaker kShapes[] = {
    {Cone::kName, make_cone},       {Hemisphere::kName, make_hemisphere},
    {Pyramid::kName, make_pyramid}, {Rock::kName, make_rock},
    {Crater::kName, make_crater},   {IceBlock::kName, make_ice_block},
    {Ridge::kName, make_ridge},     {Fracture::kName, make_fracture},
    {Pit::kName, make_pit},         {PenitenteField::kName, make_penitente_field},
};
static_assert(std::size(kShapes) == std::variant_size_v<FeatureShape>);

}  // namespace

FeatureShape feature_shape(const Json& feature) {
  for (const ShapeMaker& maker : kShapes)
    if (feature.at("type") == maker.type) return maker.make(feature);
  throw std::logic_error("no maker for " + feature.at("type").dump());
}

Feature placed_feature(const Json& feature) {
  return {number(feature, "x_m"), number(feature, "y_m"), feature_shape(feature)};
}

}  // namespace landfall
