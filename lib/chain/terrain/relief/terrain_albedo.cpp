// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D337, D347
#include "chain/terrain/relief/terrain_albedo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "base/core/error.h"
#include "base/numerics/portable_math.h"
#include "base/raster/by_rows.h"
#include "base/text/parameter_check.h"
#include "chain/terrain/relief/fractal.h"

namespace landfall {
namespace {

/// Above the layers of all bases (LargeFractal): patches change no other draw.
constexpr std::uint64_t kAlbedoDraw = 0xFFFFFFFFU;

/// Calls set(albedo, x, y) for every node.
template <class F>
void for_each_albedo(Grid<float>& layer, const F& set) {
  const GridSpec spec = layer.spec();
  by_rows(spec, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) set(layer.at({row, col}), spec.x(col), spec.y(row));
  });
}

FractalBase fractal_of(const AlbedoPatches& patches) {
  return {.hurst_exponent = patches.hurst_exponent,
          .rms_deviation_m = 1,
          .reference_length_m = patches.longest_wavelength_m,
          .longest_wavelength_m = patches.longest_wavelength_m};
}

/// The standard deviation of fractal_of(): the integral of its spectrum (FractalSpectrum) over k above
/// 2 pi / longest_wavelength_m.
double deviation_m(double hurst) {
  const double gamma = portable::gamma(1 + hurst);
  const double constant = portable::exp2(2 * hurst + 1) * gamma * gamma *
                          portable::sin(std::numbers::pi * hurst);  // C of the spectrum
  return std::sqrt(constant / (4 * std::numbers::pi * hurst)) * portable::pow(2 * std::numbers::pi, -hurst);
}

/// The level that patches of a fraction of the ground exceed.
double threshold_m(const AlbedoPatches& patches) {
  if (patches.cover_frac <= 0) return std::numeric_limits<double>::infinity();
  if (patches.cover_frac >= 1) return -std::numeric_limits<double>::infinity();
  return -deviation_m(patches.hurst_exponent) * portable::normal_quantile(patches.cover_frac);
}

[[noreturn]] void refuse_node(const std::string& path, const GridSpec& spec, const BinIndex& node,
                              float albedo) {
  std::ostringstream message;
  message << path << ": the albedo at (" << spec.x(node.col) << ", " << spec.y(node.row) << ") m is ";
  if (std::isnan(albedo)) {
    message << "missing; give another center";
  } else {
    message << albedo << ", not in [0, 1]; give /albedo/ground/scale and /albedo/ground/offset";
  }
  throw FormatError(message.str());
}

}  // namespace

void validate(const AlbedoModel& model, const GridSpec& grid) {
  const auto* const patches = std::get_if<AlbedoPatches>(&model.ground);
  if (patches == nullptr) return;
  const ParameterName name{"albedo/ground", "longest_wavelength_m"};
  const double longest_m = patches->longest_wavelength_m;
  require(longest_m > 2 * grid.resolution_m, name, longest_m,
          "above twice the grid's resolution, the shortest wave that the grid can represent");
  require(longest_m <= static_cast<double>(std::max(grid.rows, grid.cols) - 1) * grid.resolution_m, name,
          longest_m, "at most the width of the grid");
}

TerrainAlbedo::TerrainAlbedo(const AlbedoModel& model, const AlbedoSite& site, const DemLoader& load_dem)
    : model_(model), site_(site) {
  if (const auto* const raster = std::get_if<AlbedoRaster>(&model.ground)) {
    DemBase samples = raster->raster;
    samples.vertical_scale = 1;  // albedo has no unit
    raster_ = load_dem(samples, site.grid);
  }
  const auto* const patches = std::get_if<AlbedoPatches>(&model.ground);
  if (patches != nullptr && site.grid.rows * site.grid.cols > site.max_nodes)
    large_fractal_.emplace(fractal_of(*patches), FractalDraw{site.seed, kAlbedoDraw}, site.grid);
}

Grid<float> TerrainAlbedo::layer(const GridSpec& rows) {
  Grid<float> layer(rows);
  std::visit([&](const auto& ground) { fill(layer, ground); }, model_.ground);
  return layer;
}

void TerrainAlbedo::fill(Grid<float>& layer, double albedo) const {
  std::ranges::fill(layer.values(), static_cast<float>(albedo));
}

void TerrainAlbedo::fill(Grid<float>& layer, const AlbedoGradient& gradient) const {
  const double along_x = portable::cos(gradient.azimuth_rad);
  const double along_y = portable::sin(gradient.azimuth_rad);
  const GridSpec& grid = site_.grid;
  const double extent_m = (static_cast<double>(grid.cols - 1) * std::abs(along_x) +
                           static_cast<double>(grid.rows - 1) * std::abs(along_y)) *
                          grid.resolution_m;
  const double length_m = gradient.length_m.value_or(extent_m);
  for_each_albedo(layer, [&](float& node, double x_m, double y_m) {
    const double s_m = x_m * along_x + y_m * along_y;
    const double part = std::clamp(0.5 + s_m / length_m, 0.0, 1.0);
    node = static_cast<float>(gradient.from + (gradient.to - gradient.from) * part);
  });
}

void TerrainAlbedo::fill(Grid<float>& layer, const AlbedoPatches& patches) {
  Grid<double> relief(layer.spec());
  if (large_fractal_)
    large_fractal_->add_to(relief);
  else
    add_fractal(relief, fractal_of(patches), {site_.seed, kAlbedoDraw});
  const double level_m = threshold_m(patches);
  std::ranges::transform(relief.values(), layer.values().begin(), [&](double z_m) {
    return static_cast<float>(z_m > level_m ? patches.albedo : patches.albedo_between);
  });
}

void TerrainAlbedo::fill(Grid<float>& layer, const AlbedoRaster& raster) const {
  for_each_albedo(layer, [&](float& node, double x_m, double y_m) {
    const double sample =
        interpolate(raster_->samples, raster.raster.interpolation, raster_->mapping.pixel({x_m, y_m}));
    node = static_cast<float>(raster.offset + raster.scale * sample);
  });
}

void TerrainAlbedo::finish(Grid<float>& layer, const Grid<double>& z) const {
  const GridSpec& spec = layer.spec();
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      float& albedo = layer.at({row, col});
      if (std::isnan(z.at({row, col})))
        albedo = std::numeric_limits<float>::quiet_NaN();
      else if (!(albedo >= 0 && albedo <= 1))
        refuse_node(raster_ ? raster_->source.path : "albedo", spec, {row, col}, albedo);
    }
}

}  // namespace landfall
