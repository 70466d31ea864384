// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/numerics/random_seed.h"
#include "chain/terrain/populations/patterns.h"

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
  /// Only waves shorter than this are made; infinity: all that the grid holds. Empty: all waves if the model
  /// has no DEM, else those that its DEMs lack, shorter than twice the finest posting.
  std::optional<double> longest_wavelength_m{};
  friend bool operator==(const FractalBase&, const FractalBase&) = default;
};

enum class Interpolation { nearest, bilinear, bicubic };

/// The elevation of the raster that becomes z = 0: that of the site centre, or the raster's own zero (none).
enum class Datum { center, none };

/// Elevations from a raster file around a site centre, which becomes the origin of frame D. At most one of
/// `center` and `center_pixel` is set; without both, the centre is the middle of the raster.
struct DemBase {
  std::string path;
  int band = 1;
  /// Whether a band of colours is accepted; else it is refused, because colours are not elevations.
  bool takes_colours = false;
  std::optional<std::array<double, 2>> center;  ///< [x, y] in the raster's CRS (longitude before latitude)
  std::optional<std::array<double, 2>> center_pixel;  ///< [column, row] from 0, the centre of that pixel
  Interpolation interpolation = Interpolation::bicubic;
  Datum datum = Datum::center;
  /// Metres per unit of the elevations, after the band's own scale and offset; none: the unit that the raster
  /// declares, else metres.
  std::optional<double> vertical_scale{};
  /// Metres per unit of the raster's coordinates (per pixel without any), for a raster without a CRS.
  std::optional<double> horizontal_scale_m;
  std::string crs{};  ///< a definition in place of the raster's own CRS; empty: its own
  /// Samples, before scale and offset, that are holes in addition to those that the raster declares.
  std::vector<double> nodata{};
  /// Whether samples that look like fill values, but are not declared, are elevations; else they are refused.
  bool keeps_undeclared_fills = false;
  friend bool operator==(const DemBase&, const DemBase&) = default;
};

/// One term of the ground's elevation.
using Base = std::variant<PlaneBase, FractalBase, DemBase>;

/// An albedo that changes linearly along an azimuth, from one value to another over a length with the site
/// centre in its middle, and is constant beyond.
struct AlbedoGradient {
  double from = 0;
  double to = 1;
  double azimuth_rad = 0;            ///< from +x to +y
  std::optional<double> length_m{};  ///< empty: from border to border of the site
  friend bool operator==(const AlbedoGradient&, const AlbedoGradient&) = default;
};

/// Patches of one albedo and another albedo between them. A patch is where a random fractal, made of waves
/// shorter than `longest_wavelength_m`, exceeds a threshold.
struct AlbedoPatches {
  double albedo = 1;
  double albedo_between = 0;
  double cover_frac = 0.5;  ///< the expected fraction of the ground that the patches cover
  double longest_wavelength_m = 20;
  double hurst_exponent = 0.8;
  friend bool operator==(const AlbedoPatches&, const AlbedoPatches&) = default;
};

/// offset + scale times the samples of a raster. The raster's datum and vertical scale have no effect.
struct AlbedoRaster {
  DemBase raster;
  double scale = 1;
  double offset = 0;
  friend bool operator==(const AlbedoRaster&, const AlbedoRaster&) = default;
};

/// The albedo of the nodes: that of the ground (a number is the same everywhere), and those of features.
struct AlbedoModel {
  std::variant<double, AlbedoGradient, AlbedoPatches, AlbedoRaster> ground = 1.0;
  /// By index of FeatureShape; empty: features of this kind leave the albedo as it is.
  std::array<std::optional<double>, std::variant_size_v<FeatureShape>> of_kind{};
  friend bool operator==(const AlbedoModel&, const AlbedoModel&) = default;
};

/// A gridded terrain: the sum of the bases, with features on it (feature_field.h): first the listed ones,
/// then those of the patterns, each in the order of its list.
struct TerrainModel {
  std::vector<Base> bases = {PlaneBase{}};
  std::vector<Feature> features;
  std::vector<FeaturePattern> patterns;
  std::optional<AlbedoModel> albedo{};
  RandomSeed seed = {};
  friend bool operator==(const TerrainModel&, const TerrainModel&) = default;
};

/// Throws UsageError, naming the position in the model, key, value and bound, on the first invalid parameter.
/// Opens nothing.
void validate(const TerrainModel& model);

}  // namespace landfall
