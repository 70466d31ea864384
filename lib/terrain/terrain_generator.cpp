// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/terrain_generator.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
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
    throw FormatError(dem.path + ": has no elevation at the site centre, which datum \"center\" needs");
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
  if (!any_finite) throw FormatError(dem.path + ": no node of the site has an elevation");
}

/// Adds one base after the other to a terrain.
struct BaseAdder {
  GeneratedTerrain& terrain;
  const DemLoader& load_dem;
  ProgressCallback progress;
  FractalDraw draw;

  void operator()(const PlaneBase& plane) const {
    for_each_node(terrain.nodes, progress, [&](double& node, double x_m, double y_m) {
      node += plane.elevation_m + plane.slope_x * x_m + plane.slope_y * y_m;
    });
  }
  void operator()(const FractalBase& fractal) const { add_fractal(terrain.nodes, fractal, draw, progress); }
  void operator()(const DemBase& dem) const {
    const DemRaster raster = load_dem(dem, terrain.nodes.spec());
    add_raster(terrain.nodes, raster, dem, progress);
    if (terrain.dem_sources.empty()) terrain.crs_wkt = raster.crs_wkt;
    terrain.dem_sources.push_back(raster.source);
  }
};

/// A feature and the elevation that it stands on.
struct Seated {
  Feature feature;
  double at_centre_m;
};

Seated seat(const TriangulatedGrid& base, const Feature& feature, const std::string& name) {
  const double z_m = base.elevation(feature.x_m, feature.y_m);
  if (std::isfinite(z_m)) return {feature, z_m};
  const GridSpec& spec = base.nodes().spec();
  const bool on_grid = feature.x_m >= spec.x(0) && feature.x_m <= spec.x(spec.cols - 1) &&
                       feature.y_m >= spec.y(0) && feature.y_m <= spec.y(spec.rows - 1);
  std::ostringstream message;
  message << name << ": its centre (" << feature.x_m << ", " << feature.y_m << ") m is "
          << (on_grid ? "on a hole of the base" : "outside the grid");
  if (on_grid) throw FormatError(message.str());
  throw UsageError(message.str());
}

std::vector<Seated> seat_all(const TriangulatedGrid& base, const TerrainModel& model) {
  std::vector<Seated> seated;
  for (std::size_t i = 0; i < model.features.size(); ++i)
    seated.push_back(seat(base, model.features[i], "features/" + std::to_string(i)));
  for (std::size_t p = 0; p < model.patterns.size(); ++p) {
    const auto features =
        std::visit([](const auto& pattern) { return pattern.features(); }, model.patterns[p]);
    for (std::size_t i = 0; i < features.size(); ++i)
      seated.push_back(
          seat(base, features[i], "patterns/" + std::to_string(p) + " feature " + std::to_string(i)));
  }
  return seated;
}

/// A half-open range of node numbers along one axis.
struct NodeRange {
  std::int64_t begin;
  std::int64_t end;
};

/// The nodes within `reach` of `center` (both in node spacings from node 0), one more on each side, cut to
/// `limits`.
NodeRange nodes_within(double center, double reach, const NodeRange& limits) {
  const auto clamped = [&](double node) {
    return static_cast<std::int64_t>(
        std::clamp(node, static_cast<double>(limits.begin), static_cast<double>(limits.end)));
  };
  return {clamped(std::floor(center - reach)), clamped(std::ceil(center + reach) + 1)};
}

/// Applies one feature to the rows of a piece.
void stamp(Grid<double>& z, const Seated& seated, const NodeRange& rows) {
  const GridSpec& spec = z.spec();
  const Feature& feature = seated.feature;
  std::visit(
      [&](const auto& shape) {
        const double reach = shape.reach_m() / spec.resolution_m;
        const NodeRange r =
            nodes_within(feature.y_m / spec.resolution_m - static_cast<double>(spec.first_row), reach, rows);
        const NodeRange c = nodes_within(
            feature.x_m / spec.resolution_m - static_cast<double>(spec.first_col), reach, {0, spec.cols});
        for (std::int64_t row = r.begin; row < r.end; ++row)
          for (std::int64_t col = c.begin; col < c.end; ++col) {
            double& node = z.at({row, col});
            node = shape.elevation_m({node, seated.at_centre_m},
                                     {spec.x(col) - feature.x_m, spec.y(row) - feature.y_m});
          }
      },
      feature.shape);
}

void add_features(Grid<double>& z, const std::vector<Seated>& features, const ProgressCallback& progress) {
  parallel_for(
      static_cast<std::size_t>(z.spec().rows), kRowGrain,
      [&](std::size_t begin, std::size_t end) {
        const NodeRange rows{static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end)};
        for (const Seated& seated : features) stamp(z, seated, rows);
      },
      progress);
}

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
  GeneratedTerrain terrain{Grid<double>(spec), kLocalSiteCrsWkt, {}};
  for (std::size_t i = 0; i < model.bases.size(); ++i)
    std::visit(BaseAdder{terrain, load_dem, step_progress(i), {model.seed, i}}, model.bases[i]);
  TriangulatedGrid base(std::move(terrain.nodes));
  const std::vector<Seated> features = seat_all(base, model);
  terrain.nodes = std::move(base).take_nodes();
  add_features(terrain.nodes, features, step_progress(model.bases.size()));
  return terrain;
}

}  // namespace landfall
