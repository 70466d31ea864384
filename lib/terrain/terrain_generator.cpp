// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/terrain_generator.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "terrain/feature_field.h"
#include "terrain/fractal.h"
#include "terrain/triangulated_grid.h"

namespace landfall {
namespace {

constexpr std::int64_t kMaxNodes = std::int64_t{1} << 30U;  // 8 GiB of elevations
constexpr std::size_t kRowGrain = 16;

/// Calls set(z, x, y) for every node.
template <class F>
void for_each_node(Grid<double>& z, const ProgressCallback& progress, const F& set) {
  const GridSpec spec = z.spec();
  parallel_for(
      static_cast<std::size_t>(spec.rows), kRowGrain,
      [&](std::size_t begin, std::size_t end) {
        for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
          for (std::int64_t col = 0; col < spec.cols; ++col) set(z.at({row, col}), spec.x(col), spec.y(row));
      },
      progress);
}

/// z += (elevation - datum) vertical_scale at every node.
void add_raster(Grid<double>& z, const DemRaster& raster, const DemBase& dem,
                const ProgressCallback& progress) {
  const auto elevation_m = [&](const SitePoint& point) {
    return dem.vertical_scale * interpolate(raster.samples, dem.interpolation, raster.mapping.pixel(point));
  };
  const double datum_m = dem.datum == Datum::center ? elevation_m({0, 0}) : 0;
  if (!std::isfinite(datum_m))
    throw FormatError(dem.path +
                      ": has no elevation at the site centre, which datum \"center\" needs; give another "
                      "center, or datum \"none\"");
  std::atomic<bool> any_finite = false;
  for_each_node(z, progress, [&](double& node, double x_m, double y_m) {
    const PixelPosition pixel = raster.mapping.pixel({x_m, y_m});
    if (!inside(raster.samples.size, dem.interpolation, pixel)) {
      std::ostringstream message;
      message << dem.path << ": the site's node at (" << x_m << ", " << y_m << ") m lies outside the raster";
      throw FormatError(message.str());
    }
    const double elevation = dem.vertical_scale * interpolate(raster.samples, dem.interpolation, pixel);
    if (std::isfinite(elevation) && !any_finite.load(std::memory_order_relaxed)) any_finite = true;
    node += elevation - datum_m;
  });
  if (!any_finite)
    throw FormatError(dem.path + ": no node of the site has an elevation; give another center");
}

/// The rasters of a model's DEMs, in their order.
std::vector<DemRaster> load_rasters(const TerrainModel& model, const GridSpec& spec,
                                    const DemLoader& load_dem) {
  std::vector<DemRaster> rasters;
  for (const Base& base : model.bases)
    if (const auto* const dem = std::get_if<DemBase>(&base)) rasters.push_back(load_dem(*dem, spec));
  return rasters;
}

/// A raster of posting p holds wavelengths down to 2 p: fractal waves shorter than this lie in no raster.
double waves_without_raster_m(const std::vector<DemRaster>& rasters) {
  double longest_m = std::numeric_limits<double>::infinity();
  for (const DemRaster& raster : rasters) {
    const double posting_m = raster.mapping.posting_m();
    if (!(posting_m > 0) || !std::isfinite(posting_m))
      throw FormatError(raster.source.path + ": has no posting at the site centre, which is a pole of its " +
                        "longitudes; give the fractal's longest_wavelength_m in metres");
    longest_m = std::min(longest_m, 2 * posting_m);
  }
  return longest_m;
}

/// Adds one base after the other to a terrain.
struct BaseAdder {
  GeneratedTerrain& terrain;
  const std::vector<DemRaster>& rasters;
  ProgressCallback progress;
  FractalDraw draw;

  void operator()(const PlaneBase& plane) const {
    for_each_node(terrain.nodes, progress, [&](double& node, double x_m, double y_m) {
      node += plane.elevation_m + plane.slope_x * x_m + plane.slope_y * y_m;
    });
  }
  void operator()(FractalBase fractal) const {
    if (!fractal.longest_wavelength_m) fractal.longest_wavelength_m = waves_without_raster_m(rasters);
    add_fractal(terrain.nodes, fractal, draw, progress);
  }
  void operator()(const DemBase& dem) const {
    const DemRaster& raster = rasters[terrain.dem_sources.size()];
    add_raster(terrain.nodes, raster, dem, progress);
    if (terrain.dem_sources.empty()) terrain.crs_wkt = raster.crs_wkt;
    terrain.dem_sources.push_back(raster.source);
  }
};

}  // namespace

GeneratedTerrain generate_terrain(const TerrainModel& model, const GridSpec& spec, const DemLoader& load_dem,
                                  const ProgressCallback& progress) {
  validate(model);
  if (spec.rows > kMaxNodes || spec.cols > kMaxNodes || spec.rows * spec.cols > kMaxNodes)
    throw UsageError("grid: " + std::to_string(spec.cols) + " x " + std::to_string(spec.rows) +
                     " nodes are more than 2^30");
  const double steps = static_cast<double>(model.bases.size() + 1);
  const auto step_progress = [&](std::size_t step) -> ProgressCallback {
    return [&progress, steps, step](double fraction) {
      report(progress, (static_cast<double>(step) + fraction) / steps);
    };
  };
  const std::vector<DemRaster> rasters = load_rasters(model, spec, load_dem);
  GeneratedTerrain terrain{Grid<double>(spec), kLocalSiteCrsWkt, {}, {}};
  for (std::size_t i = 0; i < model.bases.size(); ++i)
    std::visit(BaseAdder{terrain, rasters, step_progress(i), {model.seed, i}}, model.bases[i]);
  FeatureField features(model, spec);
  const double last = static_cast<double>(model.bases.size());
  const auto half_progress = [&](double from) -> ProgressCallback {
    return [&progress, steps, last, from](double fraction) {
      report(progress, (last + from + fraction / 2) / steps);
    };
  };
  features.shape_ground(terrain.nodes, half_progress(0));
  TriangulatedGrid ground(std::move(terrain.nodes));
  features.seat(ground);
  terrain.nodes = std::move(ground).take_nodes();
  features.stand(terrain.nodes, half_progress(0.5));
  terrain.features = features.features();
  return terrain;
}

}  // namespace landfall
