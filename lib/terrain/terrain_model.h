// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "terrain/features/pattern.h"

namespace landfall {

/// z = elevation_m + slope_x x + slope_y y; slopes are rise over run.
struct PlaneBase {
  double elevation_m = 0;
  double slope_x = 0;
  double slope_y = 0;
  friend bool operator==(const PlaneBase&, const PlaneBase&) = default;
};

/// Self-affine relief: the rms elevation difference of two points L apart is rms_deviation_m (L /
/// reference_length_m)^hurst_exponent. The defaults describe Europa's ridged plains (a slope of 12 deg rms at
/// 10 m; Schenk 2009).
struct FractalBase {
  double hurst_exponent = 0.8;
  double rms_deviation_m = 2.13;
  double reference_length_m = 10;
  /// Only shorter waves are made; infinity: all that the grid holds. Empty: the waves that the DEMs of the
  /// same model lack, shorter than twice the finest posting; all waves without a DEM.
  std::optional<double> longest_wavelength_m{};
  friend bool operator==(const FractalBase&, const FractalBase&) = default;
};

enum class Interpolation { nearest, bilinear, bicubic };

/// The elevation at z = 0: that of the site centre, or the raster's own zero.
enum class Datum { center, none };

/// Elevations from a raster file around a site centre, which becomes the origin of frame D. At most one of
/// `center` and `center_pixel` is set; without both, the centre is the middle of the raster.
struct DemBase {
  std::string path;
  int band = 1;
  std::optional<std::array<double, 2>> center;  ///< [x, y] in the raster's CRS (longitude before latitude)
  std::optional<std::array<double, 2>> center_pixel;  ///< [column, row] from 0, the centre of that pixel
  Interpolation interpolation = Interpolation::bicubic;
  Datum datum = Datum::center;
  /// Metres per unit of the elevations, after the band's own scale and offset; none: the unit that the raster
  /// declares, else metres.
  std::optional<double> vertical_scale{};
  /// Metres per unit of the raster's coordinates (per pixel without any), for a raster without a CRS.
  std::optional<double> horizontal_scale_m;
  /// Samples, before scale and offset, that are holes beside those that the raster declares.
  std::optional<double> nodata{};
  bool keeps_undeclared_fills = false;  ///< numbers that look like undeclared fill values are elevations
  friend bool operator==(const DemBase&, const DemBase&) = default;
};

using Base = std::variant<PlaneBase, FractalBase, DemBase>;

/// Linear from one albedo to another along an azimuth, through the mean of the two at the site centre, and
/// constant beyond the length.
struct AlbedoGradient {
  double from = 0;
  double to = 1;
  double azimuth_rad = 0;            ///< from +x to +y
  std::optional<double> length_m{};  ///< between the two albedos; none: from border to border of the site
  friend bool operator==(const AlbedoGradient&, const AlbedoGradient&) = default;
};

/// Two albedos: of patches, where a fractal of wavelengths below the longest is above a threshold, and of
/// what lies between them.
struct AlbedoPatches {
  double albedo = 1;
  double albedo_between = 0;
  double cover_frac = 0.5;  ///< the expected fraction of the ground that the patches cover
  double longest_wavelength_m = 20;
  double hurst_exponent = 0.8;
  friend bool operator==(const AlbedoPatches&, const AlbedoPatches&) = default;
};

/// offset + scale times the samples of a raster, of which datum and vertical scale have no effect.
struct AlbedoRaster {
  DemBase raster;
  double scale = 1;
  double offset = 0;
  friend bool operator==(const AlbedoRaster&, const AlbedoRaster&) = default;
};

/// The albedo of the nodes: that of the ground (a number: everywhere), and those of features on it.
struct AlbedoModel {
  std::variant<double, AlbedoGradient, AlbedoPatches, AlbedoRaster> ground = 1.0;
  /// By index of FeatureShape; features of other kinds leave the albedo as it is.
  std::array<std::optional<double>, std::variant_size_v<FeatureShape>> of_kind{};
  friend bool operator==(const AlbedoModel&, const AlbedoModel&) = default;
};

/// A gridded terrain: the sum of the bases, then the features on it (feature_field.h): the listed ones in
/// their order, then those of the patterns in theirs.
struct TerrainModel {
  std::vector<Base> bases = {PlaneBase{}};
  std::vector<Feature> features;
  std::vector<FeaturePattern> patterns;
  std::optional<AlbedoModel> albedo{};
  std::uint64_t seed = 1;
  friend bool operator==(const TerrainModel&, const TerrainModel&) = default;
};

/// Throws UsageError, naming the position in the model, key, value and bound, on the first invalid parameter.
/// Opens nothing.
void validate(const TerrainModel& model);

}  // namespace landfall
