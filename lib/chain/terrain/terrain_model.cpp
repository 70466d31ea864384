// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/terrain_model.h"

#include <cmath>

#include "base/core/error.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

void validate_base(const PlaneBase& plane, const std::string& owner) {
  require_finite({owner, "elevation_m"}, plane.elevation_m);
  require_finite({owner, "slope_x"}, plane.slope_x);
  require_finite({owner, "slope_y"}, plane.slope_y);
}

void validate_base(const FractalBase& fractal, const std::string& owner) {
  const double hurst = fractal.hurst_exponent;
  require(hurst > 0 && hurst < 1, {owner, "hurst_exponent"}, hurst, "in (0, 1)");
  const double rms_m = fractal.rms_deviation_m;
  require(std::isfinite(rms_m) && rms_m >= 0, {owner, "rms_deviation_m"}, rms_m, "finite and >= 0");
  require_positive({owner, "reference_length_m"}, fractal.reference_length_m);
  const double longest_m = fractal.longest_wavelength_m.value_or(1);
  require(longest_m > 0, {owner, "longest_wavelength_m"}, longest_m, "> 0");
}

void validate_base(const DemBase& dem, const std::string& owner) {
  if (dem.path.empty()) throw UsageError(owner + "/path: is empty");
  if (dem.center && dem.center_pixel) throw UsageError(owner + ": give center or center_pixel, not both");
  require(dem.band >= 1, {owner, "band"}, dem.band, ">= 1");
  for (const double value : dem.center.value_or(std::array<double, 2>{}))
    require_finite({owner, "center"}, value);
  for (const double value : dem.center_pixel.value_or(std::array<double, 2>{}))
    require_finite({owner, "center_pixel"}, value);
  const double scale = dem.vertical_scale.value_or(1);
  require(std::isfinite(scale) && scale != 0, {owner, "vertical_scale"}, scale, "finite and other than 0");
  if (dem.horizontal_scale_m) require_positive({owner, "horizontal_scale_m"}, *dem.horizontal_scale_m);
}

void validate_surface(double albedo, const std::string& owner) {
  require_fraction({owner, "ground"}, albedo);
}

void validate_surface(const AlbedoGradient& gradient, const std::string& owner) {
  require_fraction({owner + "/ground", "from"}, gradient.from);
  require_fraction({owner + "/ground", "to"}, gradient.to);
  require_finite({owner + "/ground", "azimuth"}, gradient.azimuth_rad);
  require_positive({owner + "/ground", "length_m"}, gradient.length_m.value_or(1));
}

void validate_surface(const AlbedoPatches& patches, const std::string& owner) {
  const std::string ground = owner + "/ground";
  require_fraction({ground, "albedo"}, patches.albedo);
  require_fraction({ground, "albedo_between"}, patches.albedo_between);
  require_fraction({ground, "cover_frac"}, patches.cover_frac);
  require_positive({ground, "longest_wavelength_m"}, patches.longest_wavelength_m);
  const double hurst = patches.hurst_exponent;
  require(hurst > 0 && hurst < 1, {ground, "hurst_exponent"}, hurst, "in (0, 1)");
}

void validate_surface(const AlbedoRaster& raster, const std::string& owner) {
  validate_base(raster.raster, owner + "/ground");
  require_finite({owner + "/ground", "scale"}, raster.scale);
  require_finite({owner + "/ground", "offset"}, raster.offset);
}

void validate_albedo(const AlbedoModel& albedo) {
  std::visit([](const auto& ground) { validate_surface(ground, "albedo"); }, albedo.ground);
  for (std::size_t kind = 0; kind < albedo.of_kind.size(); ++kind)
    require_fraction({"albedo/features", feature_kinds()[kind]}, albedo.of_kind[kind].value_or(0));
}

std::string element_name(const char* list, std::size_t index) {
  return std::string(list) + "/" + std::to_string(index);
}

}  // namespace

void validate(const TerrainModel& model) {
  for (std::size_t i = 0; i < model.bases.size(); ++i)
    std::visit([&](const auto& base) { validate_base(base, element_name("base", i)); }, model.bases[i]);
  for (std::size_t i = 0; i < model.features.size(); ++i) {
    const Feature& feature = model.features[i];
    require_finite({element_name("features", i), "x_m"}, feature.x_m);
    require_finite({element_name("features", i), "y_m"}, feature.y_m);
    validate(feature.shape, element_name("features", i));
  }
  for (std::size_t i = 0; i < model.patterns.size(); ++i)
    std::visit([&](const auto& pattern) { pattern.validate(element_name("patterns", i)); },
               model.patterns[i]);
  if (model.albedo) validate_albedo(*model.albedo);
}

}  // namespace landfall
